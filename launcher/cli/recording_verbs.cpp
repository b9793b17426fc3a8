// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Verbs that look at finished runs: compare, report, info, export.
#include "common/config/yaml.hpp"
#include "common/time.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/report/comtrade_output.hpp"
#include "launcher/report/html_report.hpp"
#include "launcher/report/results.hpp"
#include "launcher/report/run_info.hpp"
#include "recorder/compare/compare.hpp"
#include "recorder/export/csv_export.hpp"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

Json manifest_of(std::filesystem::path const& folder) {
    std::ifstream stream{folder / "manifest.json"};
    return Json::parse(stream, nullptr, false);
}

std::string tick_of(Json const& manifest) {
    return manifest.is_object() && manifest.contains("clock") ? manifest["clock"].value("tick_s", "") : "";
}

std::string mode_of(Json const& manifest) {
    return manifest.is_object() && manifest.contains("clock") ? manifest["clock"].value("mode", "") : "";
}

/// How far a run came, simulated; 0 when it does not say.
double reached_of(Json const& manifest) {
    return manifest.is_object() ? manifest.value("simulated_s", 0.0) : 0.0;
}

std::filesystem::path capture_of(std::filesystem::path const& written) {
    return run_folder(written) / "bus.pcapng";
}

/// A run folder's recording; a file is taken as it is.
std::filesystem::path recording_of(std::filesystem::path const& written) {
    std::filesystem::path const folder = run_folder(written);
    return std::filesystem::is_directory(folder) ? folder / "data.mcap" : folder;
}

/// Disturbance records of a finished run, as the scenario asks for them or as the arguments say.
int export_comtrade(ExportArguments const& arguments) {
    auto const results = launcher::read_results(run_folder(arguments.run));
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
        fmt::print(stderr, "note: {}\n", note);
    }
    for (std::filesystem::path const& file : written->files) {
        fmt::print("{}\n", file.string());
    }
    return static_cast<int>(written->files.empty() ? ExitCode::usage : ExitCode::ok);
}

} // namespace

int compare(CompareArguments const& arguments) {
    Json const a = manifest_of(run_folder(arguments.a)), b = manifest_of(run_folder(arguments.b));
    CompareOptions options;
    options.tolerance = arguments.tolerance;
    options.signals = arguments.signals;
    for (auto const& [manifest, folder] : {std::pair{&a, arguments.a}, {&b, arguments.b}}) {
        if (manifest->is_object() && !manifest->value("deterministic", true)) {
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
    bool const ticks_known = !tick_of(a).empty() && !tick_of(b).empty(); // not of a file alone
    bool const ticks_differ = ticks_known && tick_of(a) != tick_of(b);
    if (ticks_differ) {
        options.skip_topics = {"simulation_clock", "clock_ack"};
    }
    auto result = compare_recordings(recording_of(arguments.a), recording_of(arguments.b), options);
    if (!result) {
        return print_error(result.error());
    }
    // Frames too, where both runs have some; stamps of real time never repeat.
    std::filesystem::path const frames_a = capture_of(arguments.a), frames_b = capture_of(arguments.b);
    std::string frames;
    if (arguments.signals.empty() && mode_of(a) == "lockstep" && mode_of(b) == "lockstep" &&
        std::filesystem::exists(frames_a) && std::filesystem::exists(frames_b)) {
        auto const equal = compare_captures(frames_a, frames_b, *result);
        if (!equal) {
            return print_error(equal.error());
        }
        frames = fmt::format(", {} frames", *equal);
    }
    for (std::string const& note : result->notes) {
        fmt::print(stderr, "note: {}\n", note);
    }
    if (ticks_differ && arguments.signals.empty()) {
        fmt::print("the ticks differ ({} s and {} s): the clock's own topics are left out\n", tick_of(a), tick_of(b));
    }
    if (result->identical()) {
        fmt::print("identical: {} {}{}{}\n", result->samples, arguments.signals.empty() ? "samples" : "values", frames,
                   arguments.tolerance > 0 ? fmt::format(" within {}", arguments.tolerance) : "");
        return 0;
    }
    Difference const& first = result->differences.front();
    std::int64_t const epoch =
        a.is_object() && a.contains("clock") ? parse_utc(a["clock"].value("epoch", "")).value_or(0) : 0;
    auto const seconds = [&](Difference const& d) {
        return arguments.signals.empty()
                   ? static_cast<double>(static_cast<std::int64_t>(d.time_ns) - epoch * 1'000'000'000) / 1e9
                   : static_cast<double>(d.time_ns) / 1e9;
    };
    fmt::print("first divergence at {} s: {}{}: {}\n", seconds(first), first.topic,
               first.process.empty() ? "" : " of " + first.process, first.what);
    for (std::size_t i = 1; i < result->differences.size(); ++i) {
        Difference const& d = result->differences[i];
        fmt::print("  then at {} s: {}{}: {}\n", seconds(d), d.topic, d.process.empty() ? "" : " of " + d.process,
                   d.what);
    }
    return static_cast<int>(ExitCode::expectation_failed);
}

int report(std::filesystem::path const& run, bool json) {
    auto const results = launcher::read_results(run_folder(run));
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
    auto const found = launcher::run_info(run_folder(run));
    if (!found) {
        return print_error(found.error());
    }
    fmt::print("{}", json ? found->json : found->text);
    return 0;
}

int export_run(ExportArguments const& arguments) {
    if (arguments.comtrade) {
        int const code = export_comtrade(arguments);
        if (code != 0 || !arguments.csv) {
            return code;
        }
    }
    std::filesystem::path const folder = run_folder(arguments.run);
    Json const manifest = manifest_of(folder);
    std::int64_t epoch = 0;
    if (manifest.is_object() && manifest.contains("clock")) {
        epoch = parse_utc(manifest["clock"].value("epoch", "")).value_or(0);
    }
    std::filesystem::path const out = arguments.out.empty() ? folder / "csv" : arguments.out;
    auto const written = export_csv(recording_of(arguments.run), epoch * 1'000'000'000, out);
    if (!written) {
        return print_error(written.error());
    }
    for (std::string const& note : written->notes) {
        fmt::print(stderr, "note: {}\n", note);
    }
    for (std::filesystem::path const& file : written->files) {
        fmt::print("{}\n", file.string());
    }
    return 0;
}

} // namespace gridspace::cli
