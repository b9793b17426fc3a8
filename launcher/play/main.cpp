// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-player: puts a recording back onto the bus, and its frames back onto a wire, on the recorded clock.
#include "common/log.hpp"
#include "common/time.hpp"
#include "common/version.hpp"
#include "launcher/play/frame_player.hpp"
#include "launcher/play/sample_player.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

namespace gridspace::play {
namespace {

using Json = nlohmann::ordered_json;

int complain(Error const& error) {
    log::error("{}", describe(error));
    return static_cast<int>(error.code);
}

/// The epoch of the run, from its manifest; nothing for a recording without one.
std::optional<std::int64_t> epoch_of(std::filesystem::path const& folder) {
    std::ifstream stream{folder / "manifest.json"};
    Json const manifest = Json::parse(stream, nullptr, false);
    if (!manifest.is_object() || !manifest.contains("clock") || !manifest["clock"].is_object() ||
        !manifest["clock"].contains("epoch") || !manifest["clock"]["epoch"].is_string()) {
        return std::nullopt;
    }
    auto const seconds = parse_utc(manifest["clock"]["epoch"].get<std::string>());
    return seconds ? std::optional{*seconds * 1'000'000'000} : std::nullopt;
}

Result<std::int64_t> instant(std::string const& text, char const* option, std::int64_t epoch_ns,
                             std::int64_t otherwise) {
    if (text.empty()) {
        return otherwise;
    }
    auto const seconds = parse_duration(text);
    if (!seconds) {
        return fail(ExitCode::usage, fmt::format("{} '{}' is not a time", option, text),
                    "for example 10s, 5min, 2h, or seconds as a number");
    }
    return epoch_ns + static_cast<std::int64_t>(seconds->to_double() * 1e9);
}

struct Players {
    std::unique_ptr<SamplePlayer> samples;
    std::optional<FramePlayer> frames;
    std::int64_t from_ns{0}, to_ns{0};
};

Result<Players> prepare(PlayOptions const& options) {
    std::error_code ignored;
    bool const folder = std::filesystem::is_directory(options.run, ignored);
    std::filesystem::path const recording = folder ? options.run / "data.mcap" : options.run;
    std::filesystem::path const capture = pcapng::capture_of_run(folder ? options.run : options.run.parent_path());
    auto epoch = epoch_of(folder ? options.run : options.run.parent_path());
    Players out;
    std::int64_t first = INT64_MAX, last = INT64_MIN;
    if (!options.frames.empty()) { // first: it may be refused
        if (!std::filesystem::exists(capture, ignored)) {
            return fail(ExitCode::usage, fmt::format("the run has no frames ('{}')", capture.string()),
                        "record.frames of the scenario says what is captured");
        }
        auto frames = FramePlayer::open(capture, epoch.value_or(0), options);
        if (!frames) {
            return std::unexpected{frames.error()};
        }
        out.frames.emplace(std::move(*frames));
        first = out.frames->first_ns();
        last = out.frames->last_ns();
    }
    if (!options.no_samples) {
        auto samples = SamplePlayer::open(recording, options);
        if (!samples) {
            return std::unexpected{samples.error()};
        }
        out.samples = std::move(*samples);
        first = std::min(first, out.samples->first_ns());
        last = std::max(last, out.samples->last_ns());
    }
    if (!epoch) {
        epoch = first; // times count from the first sample
    }
    auto const from = instant(options.start, "--start", *epoch, first),
               to = instant(options.until, "--until", *epoch, last);
    if (!from || !to) {
        return std::unexpected{!from ? from.error() : to.error()};
    }
    out.from_ns = std::max(*from, first);
    out.to_ns = std::min(*to, last);
    if (out.from_ns > out.to_ns) {
        return fail(ExitCode::usage,
                    fmt::format("nothing was recorded between {} s and {} s", static_cast<double>(*from - *epoch) / 1e9,
                                static_cast<double>(*to - *epoch) / 1e9),
                    fmt::format("the recording is from {} s to {} s", static_cast<double>(first - *epoch) / 1e9,
                                static_cast<double>(last - *epoch) / 1e9));
    }
    if (out.samples && !out.samples->note().empty()) {
        log::warning("the recording is incomplete ({}): what there is, is played, up to {:.6f} s", out.samples->note(),
                     static_cast<double>(out.samples->last_ns() - *epoch) / 1e9);
    }
    if (out.frames && out.frames->truncated()) {
        log::warning("the capture is incomplete: it was cut; what there is, is played");
    }
    return out;
}

void print_totals(PlayOptions const& options, Players& players) {
    SamplePlayer::Totals const none;
    SamplePlayer::Totals const& t = players.samples ? players.samples->totals() : none;
    std::uint64_t const sent = players.frames ? players.frames->sent() : 0,
                        not_sent = players.frames ? players.frames->not_sent() : 0;
    if (options.json) {
        Json topics = Json::object();
        for (auto const& [topic, count] : t.by_topic) {
            topics[topic] = count;
        }
        fmt::print("{}\n", Json{{"samples", t.samples},
                                {"refused", t.refused},
                                {"behind", t.behind},
                                {"worst_late_us", static_cast<double>(t.worst_late_ns) / 1e3},
                                {"complete", !players.samples || players.samples->note().empty()},
                                {"note", players.samples ? players.samples->note() : ""},
                                {"topics", topics},
                                {"frames", {{"sent", sent}, {"not_sent", not_sent}}}}
                               .dump());
        return;
    }
    if (players.samples) {
        fmt::print("{} samples of {} topics{}{}; at worst {:.3f} ms late\n", t.samples, players.samples->topics(),
                   t.refused > 0 ? fmt::format(", {} refused by DDS", t.refused) : "",
                   t.behind > 0 ? fmt::format(", readers were behind {} times", t.behind) : "",
                   static_cast<double>(t.worst_late_ns) / 1e6);
    }
    if (players.frames) {
        fmt::print("{} frames on {}{}\n", sent, options.frames,
                   not_sent > 0 ? fmt::format(", {} not sent", not_sent) : "");
    }
}

int main_function(int argc, char** argv) {
    command_line::Program program{"gridspace-player", "puts a recording back onto the bus",
                                  version_text("gridspace-player")};
    PlayOptions options;
    add_options(program.command(), options);
    program.command().add_option("--qos", options.qos, "QoS profiles of its writers (player.xml)").required();
    if (std::optional<int> const code = program.parse(argc, argv)) {
        return *code;
    }
    // A signal shall end the sleep of this thread, not of one that DDS has made.
    sigset_t stop;
    sigemptyset(&stop);
    sigaddset(&stop, SIGINT);
    sigaddset(&stop, SIGTERM);
    wire::catch_signals();
    pthread_sigmask(SIG_BLOCK, &stop, nullptr);
    auto players = prepare(options);
    if (!players) {
        return complain(players.error());
    }
    for (std::int64_t loop = 0; (options.loops == 0 || loop < options.loops) && !wire::stopped(); ++loop) {
        if (loop == 0) {
            pthread_sigmask(SIG_UNBLOCK, &stop, nullptr);
            if (players->samples) {
                options.wait ? players->samples->wait_for_readers() : players->samples->wait_until_quiet();
            }
            log::info("playing");
        }
        pthread_sigmask(SIG_BLOCK, &stop, nullptr);
        Pace const pace{players->from_ns, options.rate};
        Result<void> of_frames, of_samples;
        std::thread frames;
        if (players->frames) {
            frames = std::thread{[&] { of_frames = players->frames->play(pace, players->from_ns, players->to_ns); }};
        }
        pthread_sigmask(SIG_UNBLOCK, &stop, nullptr);
        if (players->samples) {
            of_samples = players->samples->play(pace, players->from_ns, players->to_ns);
        }
        if (frames.joinable()) {
            frames.join();
        }
        for (Result<void> const* result : {&of_samples, &of_frames}) {
            if (!*result) {
                return complain(result->error());
            }
        }
    }
    if (players->samples) {
        players->samples->finish();
    }
    print_totals(options, *players);
    return wire::stopped() ? static_cast<int>(ExitCode::interrupted) : 0;
}

} // namespace
} // namespace gridspace::play

int main(int argc, char** argv) {
    return gridspace::play::main_function(argc, argv);
}
