// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Verbs that look at finished runs: compare, report, info, export.
#include "common/config/yaml.hpp"
#include "common/json_value.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/comtrade_output.hpp"
#include "launcher/report/html_report.hpp"
#include "launcher/report/run_info.hpp"
#include "launcher/report/summary.hpp"
#include "recorder/compare/compare.hpp"
#include "recorder/export/csv_export.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <unistd.h>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

Json manifest_of(std::filesystem::path const& folder) {
    std::ifstream stream{folder / "manifest.json"};
    return Json::parse(stream, nullptr, false);
}

std::string clock_of(Json const& manifest, char const* key) {
    return value_of(part_of(manifest, "clock"), key, std::string{});
}

/// Seconds since 1970; nothing for a recording without a manifest.
std::optional<std::int64_t> epoch_of(Json const& manifest) {
    return parse_utc(clock_of(manifest, "epoch"));
}

/// How far a run came, simulated; 0 when it does not say.
double reached_of(Json const& manifest) {
    return value_of(manifest, "simulated_s", 0.0);
}

/// A run folder's recording; a file is taken as it is.
std::filesystem::path recording_of(std::filesystem::path const& run) {
    std::error_code ignored;
    return std::filesystem::is_directory(run, ignored) ? run / "data.mcap" : run;
}

/// Disturbance records of a finished run, as the scenario asks for them or as the arguments say.
int export_comtrade(ExportArguments const& arguments, std::filesystem::path const& folder) {
    auto const results = launcher::read_results(folder);
    if (!results) {
        return print_error(results.error());
    }
    config::Diagnostics diagnostics;
    auto const scenario = config::load_yaml(results->folder / "scenario.resolved.yaml", diagnostics);
    if (!scenario) {
        return print_error({ExitCode::usage, diagnostics.render(), ""});
    }
    launcher::ComtradeSettings settings = launcher::comtrade_settings(*scenario).value_or(launcher::ComtradeSettings{});
    if (!arguments.trigger.empty()) {
        settings.trigger.name = arguments.trigger;
    }
    if (settings.trigger.empty()) {
        return print_error({ExitCode::usage, "the scenario has no record.comtrade, and no --trigger was given",
                            "for example --trigger relay2.trip"});
    }
    settings.before_ms = arguments.before_ms.value_or(settings.before_ms);
    settings.after_ms = arguments.after_ms.value_or(settings.after_ms);
    for (std::string const& pattern : arguments.signals) {
        settings.signals.push_back({pattern, {}});
    }
    auto const written = write_comtrade_records(*results, *scenario, settings,
                                                arguments.out.empty() ? results->folder / "comtrade" : arguments.out);
    if (!written) {
        return print_error(written.error());
    }
    for (std::string const& note : written->notes) {
        fmt::print(stderr, "note: {}\n", printable(note));
    }
    for (std::filesystem::path const& file : written->files) {
        fmt::print("{}\n", printable(file.string()));
    }
    return static_cast<int>(written->files.empty() ? ExitCode::usage : ExitCode::ok);
}

} // namespace

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
    std::filesystem::path const frames_a = *run_a / "bus.pcapng", frames_b = *run_b / "bus.pcapng";
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

int report(std::filesystem::path const& run, bool json) {
    auto const folder = closed_run(run);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const results = launcher::read_results(*folder);
    if (!results) {
        return print_error(results.error());
    }
    if (auto ok = write_summary(*results); !ok) {
        return print_error(ok.error());
    }
    auto const html = launcher::write_html_report(*results);
    if (!html) {
        return print_error(html.error());
    }
    if (json) {
        fmt::print("{}", summary_json(*results));
    } else {
        fmt::print("{}report: {}\n", to_text(*results, ::isatty(STDOUT_FILENO) != 0), html->string());
    }
    return results->exit_code();
}

int info(std::filesystem::path const& run, bool json) {
    auto const folder = closed_run(run);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const found = launcher::run_info(*folder);
    if (!found) {
        return print_error(found.error());
    }
    fmt::print("{}", json ? found->json : found->text);
    return 0;
}

int export_run(ExportArguments const& arguments) {
    auto const folder = closed_run(arguments.run);
    if (!folder) {
        return print_error(folder.error());
    }
    if (arguments.comtrade) {
        int const code = export_comtrade(arguments, *folder);
        if (code != 0 || !arguments.csv) {
            return code;
        }
    }
    Json const manifest = manifest_of(*folder);
    std::int64_t const epoch = epoch_of(manifest).value_or(0);
    std::filesystem::path const out = arguments.out.empty() ? *folder / "csv" : arguments.out;
    auto const written = export_csv(recording_of(*folder), epoch * 1'000'000'000, out);
    if (!written) {
        return print_error(written.error());
    }
    for (std::string const& note : written->notes) {
        fmt::print(stderr, "note: {}\n", printable(note));
    }
    for (std::filesystem::path const& file : written->files) {
        fmt::print("{}\n", printable(file.string()));
    }
    return 0;
}

} // namespace gridspace::cli
