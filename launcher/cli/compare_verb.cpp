// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/json_value.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/manifest.hpp"
#include "launcher/cli/verbs.hpp"
#include "recorder/compare/compare.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::filesystem::path a, b;
    double tolerance{0};
    std::vector<std::string> signals;
};

/// What the reader should know of two runs before their samples are compared.
void note_conditions(Json const& a, Json const& b, CompareArguments const& arguments) {
    for (auto const& [manifest, folder] : {std::pair{&a, arguments.a}, {&b, arguments.b}}) {
        if (manifest->is_object() && !value_of(*manifest, "deterministic", true)) {
            fmt::print(stderr,
                       "note: '{}' ran in real time: its samples depend on the machine; --signals and --tolerance "
                       "compare what matters\n",
                       folder.string());
        }
    }
    if (a.is_object() && b.is_object() &&
        reached_of(a) != reached_of(b)) { // what is recorded on change only may be equal all the same
        fmt::print(stderr, "note: the runs ended at different times, at {} s and at {} s\n", reached_of(a),
                   reached_of(b));
    }
}

bool ticks_differ(Json const& a, Json const& b) {
    bool const known = !clock_of(a, "tick_s").empty() && !clock_of(b, "tick_s").empty(); // not of a file alone
    return known && clock_of(a, "tick_s") != clock_of(b, "tick_s");
}

/// How many frames are equal; `result` learns of those that are not. Nothing where there are no frames to compare:
/// both runs have to have some, and stamps of real time never repeat.
Result<std::optional<std::uint64_t>> compare_frames(std::filesystem::path const& run_a,
                                                    std::filesystem::path const& run_b, Json const& a, Json const& b,
                                                    Comparison& result) {
    std::filesystem::path const frames_a = pcapng::capture_of_run(run_a), frames_b = pcapng::capture_of_run(run_b);
    if (clock_of(a, "mode") != "lockstep" || clock_of(b, "mode") != "lockstep" || !std::filesystem::exists(frames_a) ||
        !std::filesystem::exists(frames_b)) {
        return std::nullopt;
    }
    auto const equal = compare_captures(frames_a, frames_b, result);
    if (!equal) {
        return std::unexpected{equal.error()};
    }
    return std::optional{*equal};
}

void print_differences(Comparison const& result, Json const& a, Json const& b, bool by_simulated_time) {
    if (!by_simulated_time && epoch_of(a) && epoch_of(b) && epoch_of(a) != epoch_of(b)) {
        fmt::print(
            stderr,
            "note: the epochs differ ({} and {}), and so do all instants; --signals compares by simulated time\n",
            clock_of(a, "epoch"), clock_of(b, "epoch"));
    }
    std::int64_t const epoch = std::min(epoch_of(a).value_or(0), epoch_of(b).value_or(INT64_MAX)); // no time before it
    auto const seconds = [&](Difference const& d) {
        return by_simulated_time
                   ? static_cast<double>(d.time_ns) / 1e9
                   : static_cast<double>(static_cast<std::int64_t>(d.time_ns) - epoch * 1'000'000'000) / 1e9;
    };
    auto const place = [&](Difference const& d) { // names and values are the recording's
        return printable(
            fmt::format("{} s: {}{}: {}", seconds(d), d.topic, d.process.empty() ? "" : " of " + d.process, d.what));
    };
    fmt::print("first divergence at {}\n", place(result.differences.front()));
    for (std::size_t i = 1; i < result.differences.size(); ++i) {
        fmt::print("  then at {}\n", place(result.differences[i]));
    }
}

int compare(CompareArguments const& arguments) {
    auto const run_a = closed_run(arguments.a), run_b = closed_run(arguments.b);
    for (auto const* run : {&run_a, &run_b}) {
        if (!*run) {
            return print_error(run->error());
        }
    }
    Json const a = manifest_of(*run_a), b = manifest_of(*run_b);
    note_conditions(a, b, arguments);
    bool const everything = arguments.signals.empty(), own_clocks = ticks_differ(a, b);
    CompareOptions options;
    options.tolerance = arguments.tolerance;
    options.signals = arguments.signals;
    if (own_clocks) {
        options.skip_topics = {"simulation_clock", "clock_ack"};
    }
    auto result = compare_recordings(recording_of(*run_a), recording_of(*run_b), options);
    if (!result) {
        return print_error(result.error());
    }
    std::optional<std::uint64_t> frames;
    if (everything) {
        auto const equal = compare_frames(*run_a, *run_b, a, b, *result);
        if (!equal) {
            return print_error(equal.error());
        }
        frames = *equal;
    }
    for (std::string const& note : result->notes) {
        fmt::print(stderr, "note: {}\n", printable(note));
    }
    if (own_clocks && everything) {
        fmt::print("the ticks differ ({} s and {} s): the clock's own topics are left out\n", clock_of(a, "tick_s"),
                   clock_of(b, "tick_s"));
    }
    if (!result->identical()) {
        print_differences(*result, a, b, !everything);
        return static_cast<int>(ExitCode::expectation_failed);
    }
    if (result->samples + frames.value_or(0) == 0) {
        return print_error({ExitCode::usage, "neither run has recorded anything: nothing was compared",
                            "record.samples of the scenario, and a process with program: gridspace-recorder"});
    }
    fmt::print("identical: {} {}{}{}\n", result->samples, everything ? "samples" : "values",
               frames ? fmt::format(", {} frames", *frames) : "",
               arguments.tolerance > 0 ? fmt::format(" within {}", arguments.tolerance) : "");
    return 0;
}

} // namespace

void add_compare(Command app, Action& action) {
    auto const a = std::make_shared<CompareArguments>();
    Command verb =
        app.add_subcommand("compare", "compare the recordings of two runs: identical, or the first divergence");
    verb.add_option("RUN_A", a->a, "run folder or recording").required();
    verb.add_option("RUN_B", a->b, "run folder or recording").required();
    verb.add_option("--tolerance", a->tolerance, "of numbers, absolute or relative").check(not_negative());
    verb.add_option("--signals", a->signals, "compare only these recorded signals (patterns)").delimiter(',');
    verb.callback([a, &action] { action = [a] { return compare(*a); }; });
}

} // namespace gridspace::cli
