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

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
    std::filesystem::path a, b;
    double tolerance{0};
    std::vector<std::string> signals;
};

int compare(CompareArguments const& arguments) {
    auto const run_a = closed_run(arguments.a), run_b = closed_run(arguments.b);
    for (auto const* run : {&run_a, &run_b}) {
        if (!*run) {
            return print_error(run->error());
        }
    }
    Json const a = manifest_of(*run_a), b = manifest_of(*run_b);
    CompareOptions options;
    options.tolerance = arguments.tolerance;
    options.signals = arguments.signals;
    for (auto const& [manifest, folder] : {std::pair{&a, arguments.a}, {&b, arguments.b}}) {
        if (manifest->is_object() && !value_of(*manifest, "deterministic", true)) {
            fmt::print(stderr,
                       "note: '{}' ran in real time: its samples depend on the machine; --signals and --tolerance "
                       "compare what matters\n",
                       folder.string());
        }
    }
    if (reached_of(a) != reached_of(b)) { // what is recorded on change only may be equal all the same
        fmt::print(stderr, "note: the runs ended at different times, at {} s and at {} s\n", reached_of(a),
                   reached_of(b));
    }
    bool const ticks_known = !clock_of(a, "tick_s").empty() && !clock_of(b, "tick_s").empty(); // not of a file alone
    bool const ticks_differ = ticks_known && clock_of(a, "tick_s") != clock_of(b, "tick_s");
    if (ticks_differ) {
        options.skip_topics = {"simulation_clock", "clock_ack"};
    }
    auto result = compare_recordings(recording_of(*run_a), recording_of(*run_b), options);
    if (!result) {
        return print_error(result.error());
    }
    // Frames too, where both runs have some; stamps of real time never repeat.
    std::filesystem::path const frames_a = pcapng::capture_of_run(*run_a), frames_b = pcapng::capture_of_run(*run_b);
    std::string frames;
    std::uint64_t equal_frames = 0;
    if (arguments.signals.empty() && clock_of(a, "mode") == "lockstep" && clock_of(b, "mode") == "lockstep" &&
        std::filesystem::exists(frames_a) && std::filesystem::exists(frames_b)) {
        auto const equal = compare_captures(frames_a, frames_b, *result);
        if (!equal) {
            return print_error(equal.error());
        }
        equal_frames = *equal;
        frames = fmt::format(", {} frames", *equal);
    }
    for (std::string const& note : result->notes) {
        fmt::print(stderr, "note: {}\n", printable(note));
    }
    if (ticks_differ && arguments.signals.empty()) {
        fmt::print("the ticks differ ({} s and {} s): the clock's own topics are left out\n", clock_of(a, "tick_s"),
                   clock_of(b, "tick_s"));
    }
    if (result->identical() && result->samples + equal_frames == 0) {
        return print_error({ExitCode::usage, "neither run has recorded anything: nothing was compared",
                            "record.samples of the scenario, and a process with program: gridspace-recorder"});
    }
    if (result->identical()) {
        fmt::print("identical: {} {}{}{}\n", result->samples, arguments.signals.empty() ? "samples" : "values", frames,
                   arguments.tolerance > 0 ? fmt::format(" within {}", arguments.tolerance) : "");
        return 0;
    }
    if (arguments.signals.empty() && epoch_of(a) && epoch_of(b) && epoch_of(a) != epoch_of(b)) {
        fmt::print(
            stderr,
            "note: the epochs differ ({} and {}), and so do all instants; --signals compares by simulated time\n",
            clock_of(a, "epoch"), clock_of(b, "epoch"));
    }
    Difference const& first = result->differences.front();
    std::int64_t const epoch = std::min(epoch_of(a).value_or(0), epoch_of(b).value_or(INT64_MAX)); // no time before it
    auto const seconds = [&](Difference const& d) {
        return arguments.signals.empty()
                   ? static_cast<double>(static_cast<std::int64_t>(d.time_ns) - epoch * 1'000'000'000) / 1e9
                   : static_cast<double>(d.time_ns) / 1e9;
    };
    auto const place = [&](Difference const& d) { // names and values are the recording's
        return printable(
            fmt::format("{} s: {}{}: {}", seconds(d), d.topic, d.process.empty() ? "" : " of " + d.process, d.what));
    };
    fmt::print("first divergence at {}\n", place(first));
    for (std::size_t i = 1; i < result->differences.size(); ++i) {
        fmt::print("  then at {}\n", place(result->differences[i]));
    }
    return static_cast<int>(ExitCode::expectation_failed);
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
