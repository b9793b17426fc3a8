// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-recorder: every sample of the topics it is given, into data.mcap. In lockstep it is a member and loses
// nothing; in real time nothing waits for it.
#include "bus/daemon.hpp"
#include "bus/tick_grid.hpp"
#include "bus/topics.hpp"
#include "common/idl/cdr_visitor.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "recorder/app/frame_capture.hpp"
#include "recorder/app/recorder_config.hpp"
#include "recorder/mcap/mcap_writer.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

namespace gridspace::recorder {
namespace {

/// One topic's way from the bus into the file.
struct Tap {
    std::string topic;
    std::string type;
    std::string idl;
    std::shared_ptr<bus::CdrReader> reader;
    idl::Model model;
    std::size_t model_type{0};
    bool has_stamp{false};                           ///< the type has a member time_ns
    std::uint16_t schema{0};                         ///< 0: not added yet
    std::map<std::uint32_t, std::uint16_t> channels; ///< by process
    std::map<std::uint32_t, std::uint32_t> sequences;
    std::uint64_t dropped{0}; ///< as reported
};

struct Entry {
    SimTime time;
    std::size_t tap;
    bus::Origin origin;
    std::vector<std::byte> cdr;
};

/// Real time: what may wait of one topic while the disk is slow.
constexpr std::size_t kMaxWaitingOfTopic = 32U << 20U;

class RecorderShell {
  public:
    RecorderShell(RecorderConfig const& config, bus::Node& node, StatusReporter& status, mcap::Writer file)
        : config_{config}, node_{node}, status_{status}, file_{std::move(file)},
          epoch_ns_{node.config().clock.epoch_unix_s * 1'000'000'000} {}

    /// However the recording ends, what was recorded can be read like that of a run to its end: with its index.
    Result<void> run() {
        Result<void> result = record();
        if (!result) {
            for (auto const& closed : {frames_ ? close_capture() : Result<void>{}, file_.close()}) {
                if (!closed) { // after a failed write nothing more is written, and the first error says why
                    log::warning("the recording is not complete: {}", closed.error().message);
                }
            }
        }
        return result;
    }

  private:
    Result<void> record() {
        if (auto ok = open_taps(); !ok) {
            return ok;
        }
        auto frames = FrameCapture::open(node_, config_.capture);
        if (!frames) {
            return std::unexpected{frames.error()};
        }
        frames_ = std::move(*frames);
        node_.listen_in_rounds(std::chrono::milliseconds{1});
        if (auto ok = node_.start(); !ok) {
            return ok;
        }
        while (true) {
            if (!node_.lockstep()) {
                // Samples wait in their readers: one round for all of them costs less than one for each.
                std::this_thread::sleep_for(std::chrono::milliseconds{20});
            }
            auto tick = node_.next(std::chrono::steady_clock::now());
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            report_drops(*tick ? node_.time_base().seconds((*tick)->time) : last_s_, !*tick || (*tick)->final);
            if (!*tick) {
                auto const closed = close_capture();
                auto recording = file_.close();
                return closed ? recording : closed;
            }
            take_due((*tick)->final);
            // Taken is acknowledged: in lockstep the others go on while it is compressed and written.
            if (!(*tick)->final) {
                if (auto ok = node_.done(**tick, bus::TickGrid::kNever); !ok) {
                    return ok;
                }
            }
            if (auto ok = write_taken(); !ok) {
                return ok;
            }
            if ((*tick)->final) {
                if (auto ok = node_.lockstep() ? Result<void>{} : take_last_words(); !ok) {
                    return ok;
                }
                report_lost();
                if (auto ok = close_capture(); !ok) {
                    return ok;
                }
                if (auto ok = file_.finish(); !ok) {
                    return ok;
                }
                log::info("{} samples, {} octets", file_.messages(), file_.octets());
                if (auto ok = node_.done(**tick, bus::TickGrid::kNever); !ok) {
                    return ok;
                }
                return file_.close(); // the simulator does not wait for the disk
            }
            if (auto ok = flush_sometimes(); !ok) {
                return ok;
            }
        }
    }

    /// Real time: the others learn of the end when this process does, publish their last counters, and leave. One that
    /// is still there after five seconds is named.
    Result<void> take_last_words() {
        constexpr auto kTime = std::chrono::milliseconds{300}, kRound = std::chrono::milliseconds{20};
        constexpr auto kLongest = std::chrono::seconds{5};
        auto const begin = std::chrono::steady_clock::now();
        auto gone = begin; // not before that
        while (true) {
            auto const remaining = node_.writers_here(); // before what they have sent is taken
            std::this_thread::sleep_for(kRound);
            take_due(true);
            if (auto ok = write_taken(); !ok) {
                return ok;
            }
            auto const now = std::chrono::steady_clock::now();
            gone = remaining.empty() ? gone : now;
            // What is still missing of a simulator that has left is only what waits in this machine's sockets.
            bool const all = remaining.empty() && (node_.missing_of_simulator().empty() || now - gone >= kTime);
            if (node_.stop_is_requested() || (all && now - begin >= kTime)) {
                return {};
            }
            if (now - begin >= kLongest) {
                report_remaining(remaining);
                return {};
            }
        }
    }

    void report_remaining(std::vector<std::string> const& processes) {
        if (!processes.empty()) {
            std::string const text = fmt::format(
                "{} {} still there five seconds after the end: the last samples may not be in the recording",
                join(processes, ", "), processes.size() == 1 ? "is" : "are");
            log::warning("{}", text);
            status_.event(last_s_, node_.config().process, "still_there", text);
        }
    }

    /// A topic with what its IDL says of its type; without a reader.
    static Result<Tap> tap_of(RecorderConfig::Topic const& topic) {
        Tap tap;
        tap.topic = topic.name;
        tap.type = topic.type;
        tap.idl = std::string{bus::idl_of_type(topic.type)};
        if (!topic.idl.empty()) {
            std::ifstream stream{topic.idl};
            std::stringstream text;
            text << stream.rdbuf();
            tap.idl = text.str();
        }
        auto model = idl::parse(tap.idl);
        if (!model) {
            return fail(ExitCode::usage, fmt::format("the IDL of type '{}': {}", topic.type, model.error().message));
        }
        auto const type = model->find(topic.type);
        if (!type) {
            return fail(ExitCode::usage,
                        fmt::format("topic '{}' carries '{}', and no IDL defines that type", topic.name, topic.type),
                        "`idl: FILE` beside its type names the file that does");
        }
        tap.model_type = *type;
        tap.has_stamp = std::any_of(model->types[*type].members.begin(), model->types[*type].members.end(),
                                    [](auto const& m) { return m.name == "time_ns"; });
        tap.model = std::move(*model);
        return tap;
    }

    /// `reader`: null for one that is made here.
    Result<void> add_tap(RecorderConfig::Topic const& topic, std::shared_ptr<bus::CdrReader> reader) {
        auto tap = tap_of(topic);
        if (!tap) {
            return std::unexpected{tap.error()};
        }
        if (reader == nullptr) {
            bus::Codec codec;
            codec.type_name = topic.type;
            codec.keyed = tap->model.is_keyed(tap->model_type);
            if (bus::Codec const* known = bus::find_codec(topic.type); known != nullptr) {
                codec = *known;
            }
            auto opened = node_.cdr_reader(topic.name, codec);
            if (!opened) {
                return std::unexpected{opened.error()};
            }
            reader = std::move(*opened);
        }
        if (!node_.lockstep()) {
            reader->bound(kMaxWaitingOfTopic);
        }
        tap->reader = std::move(reader);
        taps_.push_back(std::move(*tap));
        return {};
    }

    Result<void> open_taps() {
        if (auto ok = add_tap({"simulation_clock", "SimClock", {}}, node_.tap_clock()); !ok) {
            return ok;
        }
        if (node_.lockstep()) {
            if (auto ok = add_tap({"clock_ack", "ClockAck", {}}, node_.tap_acknowledgements()); !ok) {
                return ok;
            }
        }
        for (RecorderConfig::Topic const& topic : config_.topics) {
            if (auto ok = add_tap(topic, nullptr); !ok) {
                return ok;
            }
        }
        std::sort(taps_.begin(), taps_.end(), [](Tap const& a, Tap const& b) { return a.topic < b.topic; });
        return {};
    }

    /// Everything whose time has come, in the order (time, topic, process, writer, sequence), which is the same in
    /// every run.
    void take_due(bool final) {
        frames_->take_due();
        batch_.clear();
        for (std::size_t i = 0; i < taps_.size(); ++i) {
            if (final) {
                taps_[i].reader->release({INT64_MAX}); // effects that lie beyond the end
            }
            for (auto& received : taps_[i].reader->take()) {
                SimTime time = received.origin.time;
                if (taps_[i].has_stamp) {
                    if (auto const ns =
                            idl::find_integer(taps_[i].model, taps_[i].model_type, received.value.cdr, "time_ns")) {
                        time = node_.time_base().from_nanoseconds(*ns);
                    }
                }
                batch_.push_back({time, i, received.origin, std::move(received.value.cdr)});
            }
        }
        std::stable_sort(batch_.begin(), batch_.end(), [](Entry const& a, Entry const& b) {
            return std::tuple{a.time, a.tap, a.origin.process, a.origin.writer, a.origin.sequence} <
                   std::tuple{b.time, b.tap, b.origin.process, b.origin.writer, b.origin.sequence};
        });
    }

    Result<void> write_taken() {
        if (auto ok = frames_->write_taken(); !ok) {
            return ok;
        }
        for (Entry const& entry : batch_) {
            if (auto ok = write(entry); !ok) {
                return ok;
            }
        }
        return {};
    }

    Result<void> write(Entry const& entry) {
        Tap& tap = taps_[entry.tap];
        if (tap.schema == 0) {
            tap.schema = file_.add_schema(tap.type, "omgidl", tap.idl);
        }
        auto channel = tap.channels.find(entry.origin.process);
        if (channel == tap.channels.end()) {
            std::uint16_t const id =
                file_.add_channel(tap.schema, tap.topic, "cdr", {{"process", node_.process_name(entry.origin)}});
            channel = tap.channels.emplace(entry.origin.process, id).first;
        }
        std::int64_t const ns = epoch_ns_ + node_.time_base().nanoseconds(entry.time);
        return file_.write(channel->second, ++tap.sequences[entry.origin.process],
                           static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns)), entry.cdr);
    }

    /// In real time nothing waits for the recorder; what it could not keep is said, once a second at most and at the
    /// end.
    void report_drops(double now_s, bool at_the_end) {
        last_s_ = now_s;
        auto const now = std::chrono::steady_clock::now();
        if (node_.lockstep() || (now - reported_ < std::chrono::seconds{1} && !at_the_end)) {
            return;
        }
        reported_ = now;
        for (Tap& tap : taps_) {
            if (std::uint64_t const dropped = tap.reader->dropped(); dropped != tap.dropped) {
                std::string const text = fmt::format(
                    "{} samples of '{}' are not in the recording: the disk is too slow ({} since the start)",
                    dropped - tap.dropped, tap.topic, dropped);
                log::warning("{}", text);
                status_.event(now_s, node_.config().process, "samples_dropped", text);
                tap.dropped = dropped;
            }
        }
    }

    /// Real time: what came too slowly for the writer's history, or not at all.
    void report_lost() {
        std::string const missing = node_.lockstep() ? "" : node_.missing_of_simulator();
        if (!missing.empty()) {
            std::string const text = "not in the recording, because this machine was too slow: " + missing;
            log::warning("{}", text);
            status_.event(last_s_, node_.config().process, "samples_dropped", text);
        }
    }

    /// What the capture lost is in the file, interface by interface, and said.
    Result<void> close_capture() {
        auto const closed = frames_->close();
        if (std::uint64_t const dropped = frames_->dropped(); dropped > 0) {
            std::string const text =
                fmt::format("{} frames are not in the capture: this machine was too slow", dropped);
            log::warning("{}", text);
            status_.event(last_s_, node_.config().process, "frames_dropped", text);
        }
        for (std::string const& text : frames_->strangers()) {
            status_.event(last_s_, node_.config().process, "foreign_frames", text);
        }
        frames_.reset();
        return closed;
    }

    /// Whatever happens, not much more than a second of recording is lost: also of a run at the pace of the wall clock.
    Result<void> flush_sometimes() {
        auto const now = std::chrono::steady_clock::now();
        if (now - flushed_ < std::chrono::seconds{1}) {
            return {};
        }
        flushed_ = now;
        return file_.flush();
    }

    RecorderConfig const& config_;
    bus::Node& node_;
    StatusReporter& status_;
    mcap::Writer file_;
    std::int64_t epoch_ns_;
    std::unique_ptr<FrameCapture> frames_;
    std::vector<Tap> taps_;
    std::vector<Entry> batch_;
    std::chrono::steady_clock::time_point flushed_{std::chrono::steady_clock::now()}, reported_{flushed_};
    double last_s_{0};
};

} // namespace
} // namespace gridspace::recorder

int main(int argc, char** argv) {
    using namespace gridspace;
    recorder::RecorderConfig config;
    program::Declaration const declaration = recorder::recorder_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) -> Result<void> {
                            auto file = mcap::Writer::create(config.file, {.compress = config.compress});
                            if (!file) {
                                return std::unexpected{file.error()};
                            }
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                return recorder::RecorderShell{config, node, run.status, std::move(*file)}.run();
                            });
                        },
                        true,
                        recorder::recorder_declaration};
    return run_daemon(daemon, argc, argv);
}
