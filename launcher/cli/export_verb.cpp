// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/manifest.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/comtrade_output.hpp"
#include "launcher/report/latency_traces.hpp"
#include "recorder/export/csv_export.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace gridspace::cli {
namespace {

struct ExportArguments {
    std::filesystem::path run, out;
    bool csv{false}, comtrade{false}, cff{false}, latency{false};
    std::string trigger; ///< comtrade: these override what the scenario says
    std::optional<double> before_ms, after_ms;
    std::vector<std::string> signals;
};

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
    settings.single_file |= arguments.cff;
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

/// How long each frame of the run was under way.
int export_latency(ExportArguments const& arguments, std::filesystem::path const& folder) {
    auto const results = launcher::read_results(folder);
    if (!results) {
        return print_error(results.error());
    }
    auto const written = launcher::write_latency_traces(
        results->signals, arguments.out.empty() ? results->folder / "latency" : arguments.out);
    if (!written) {
        return print_error(written.error());
    }
    for (std::filesystem::path const& file : *written) {
        fmt::print("{}\n", printable(file.string()));
    }
    if (written->empty()) {
        return print_error({ExitCode::usage, "no frame of this run has a time under way",
                            "in lockstep frames take the simulated time of their link: run it with "
                            "`clock: {mode: realtime}`"});
    }
    return 0;
}

int export_run(ExportArguments const& arguments) {
    auto const folder = closed_run(arguments.run);
    if (!folder) {
        return print_error(folder.error());
    }
    if (arguments.comtrade || arguments.latency) {
        int code = arguments.comtrade ? export_comtrade(arguments, *folder) : 0;
        if (code == 0 && arguments.latency) {
            code = export_latency(arguments, *folder);
        }
        if (code != 0 || !arguments.csv) {
            return code;
        }
    }
    nlohmann::ordered_json const manifest = manifest_of(*folder);
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

} // namespace

void add_export(Command app, Action& action) {
    auto const a = std::make_shared<ExportArguments>();
    Command verb = app.add_subcommand("export", "write a recording as tables, or as disturbance records");
    verb.add_option("RUN", a->run, "run folder, or latest").required();
    verb.add_flag("--csv", a->csv, "CSV: one table per topic (the default)");
    verb.add_flag("--comtrade", a->comtrade, "COMTRADE (IEEE C37.111-2013), ASCII and BINARY, around each trigger");
    verb.add_flag("--cff", a->cff, "COMTRADE: one .cff in place of .cfg and .dat");
    verb.add_flag("--latency", a->latency,
                  "time under way of each sample and message of a run in real time, as CSV and as svtrace writes it");
    verb.add_option("--trigger", a->trigger,
                    "COMTRADE: relay2.trip, a signal that rises, or an event (default: as the scenario says)");
    verb.add_option("--before-ms", a->before_ms, "COMTRADE: begin before the trigger").check(in_range(0.0, 60000.0));
    verb.add_option("--after-ms", a->after_ms, "COMTRADE: end after the trigger").check(in_range(0.001, 60000.0));
    verb.add_option("--signals", a->signals, "COMTRADE: further analog channels (patterns)").delimiter(',');
    verb.add_option("--out", a->out, "folder (default: RUN/csv, RUN/comtrade, RUN/latency)");
    verb.callback([a, &action] { action = [a] { return export_run(*a); }; });
}

} // namespace gridspace::cli
