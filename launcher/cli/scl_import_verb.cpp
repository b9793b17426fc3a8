// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace scl import`: the file of a station becomes a scenario that runs.
#include "launcher/cli/scl_import_verb.hpp"
#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/scl_file.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/scl/station_report.hpp"
#include "sim/network/network_config.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

namespace fs = std::filesystem;
using launcher::MeasuringPoint;

/// Reading a scenario of 2000 processes takes minutes.
constexpr std::size_t kCheckedProcesses = 100;

struct ImportArguments {
    fs::path file, out, network, map;
    std::vector<std::string> ieds;
    double nominal_hz{50};
    bool realtime{false}, streams_only{false}, json{false}, strict{false}, overwrite{false};
};

Result<void> write(fs::path const& file, std::string const& text, bool overwrite) {
    std::error_code ignored;
    if (!overwrite && fs::exists(file, ignored)) {
        return fail(ExitCode::usage, fmt::format("'{}' is there already", file.string()),
                    "another --out, or --overwrite");
    }
    return launcher::replace_file(file, text);
}

int only_streams(ImportArguments const& a) {
    auto const imported = read_scl_file(a.file, {a.ieds, a.nominal_hz});
    if (!imported) {
        return print_error(imported.error());
    }
    if (imported->streams.entries.empty()) {
        return print_error({ExitCode::usage, fmt::format("'{}' has no stream that can be used", a.file.string()),
                            "the notes above say why"});
    }
    config::Node root = config::Node::map();
    root.set("streams", imported->streams);
    if (a.out.empty()) {
        fmt::print("{}", config::to_yaml(root));
        return 0;
    }
    auto const written = launcher::replace_file(a.out, config::to_yaml(root));
    return written ? 0 : print_error(written.error());
}

int print_mistakes(config::Diagnostics const& diagnostics) {
    fmt::print(stderr, "{}\n", diagnostics.render());
    return static_cast<int>(ExitCode::usage);
}

/// `--map`: {default: {ct, vt}, IED: {ct, vt}}.
void read_map(fs::path const& file, launcher::StationOptions& out, config::Diagnostics& diagnostics) {
    auto const root = config::load_yaml(file, diagnostics);
    if (!root) {
        return;
    }
    if (!root->is_map()) {
        diagnostics.error(root->where, fmt::format("the map is {}", config::describe(*root)),
                          "expected IEDs: MU1: {ct: CT1, vt: VT1}, and default: {ct: ..., vt: ...}");
        return;
    }
    for (config::Node::Entry const& entry : root->entries) {
        MeasuringPoint point = out.usual;
        config::read_fields(entry.value, entry.key, diagnostics, [&](config::Fields& f) {
            f.text("ct", point.ct, {.doc = "current transformer of the network"});
            f.text("vt", point.vt, {.doc = "voltage transformer of the network"});
        });
        if (entry.key == "default") {
            out.usual = point;
        } else {
            out.points[entry.key] = point;
        }
    }
}

/// Where the merging units measure: in the network that is given, or in the usual one. False: mistakes were printed.
bool choose_network(ImportArguments const& a, launcher::StationOptions& options, int& code) {
    config::Diagnostics diagnostics;
    options.usual = {"CT1", "VT1"};
    std::optional<sim::Network> network;
    if (!a.network.empty()) {
        network = sim::load_network(a.network, diagnostics);
        if (network && (network->cts.empty() || network->vts.empty())) {
            diagnostics.error(network->where,
                              "the network has no `cts` or no `vts`: merging units have nothing to measure",
                              "a current and a voltage transformer (docs/reference/components.md)");
        } else if (network) {
            options.usual = {network->cts.front().name.name, network->vts.front().name.name};
        }
    }
    if (!a.map.empty() && diagnostics.ok()) {
        read_map(a.map, options, diagnostics);
    }
    auto const must_be = [&](MeasuringPoint const& point, std::string const& ied) {
        bool const known =
            network ? sim::find(network->cts, point.ct) != nullptr && sim::find(network->vts, point.vt) != nullptr
                    : point.ct == "CT1" && point.vt == "VT1";
        if (!known && diagnostics.ok()) {
            diagnostics.error({},
                              fmt::format("{} measures at ct '{}' and vt '{}', which the network does not have", ied,
                                          point.ct, point.vt),
                              network ? "names of its `cts` and `vts`" : "give the network: --network FILE");
        }
    };
    must_be(options.usual, "default");
    for (auto const& [ied, point] : options.points) {
        must_be(point, ied);
    }
    if (!diagnostics.ok()) {
        code = print_mistakes(diagnostics);
    }
    return diagnostics.ok();
}

/// Writes the scenario, and the network where none is given.
Result<void> write_scenario(ImportArguments const& a, launcher::StationScenario const& made, fs::path const& out,
                            fs::path const& network_file) {
    if (a.network.empty()) {
        auto const written =
            write(network_file, launcher::usual_network(network_file.stem().string(), a.nominal_hz), a.overwrite);
        if (!written) {
            return written;
        }
    }
    std::string const head =
        fmt::format("# Made of {} by gridspace scl import. It is yours now: change what you like.\n---\n",
                    a.file.filename().string());
    return write(out, head + config::to_yaml(made.root), a.overwrite);
}

/// `network_file`: what the scenario's network is called where none is given.
launcher::StationOptions options_of(ImportArguments const& a, fs::path const& out, fs::path const& network_file) {
    launcher::StationOptions options;
    options.name = out.stem().string();
    std::replace_if(
        options.name.begin(), options.name.end(), [](char c) { return !is_identifier(std::string{'_', c}); }, '_');
    options.ieds = a.ieds;
    options.nominal_hz = a.nominal_hz;
    options.realtime = a.realtime;
    fs::path const folder = fs::absolute(out).parent_path();
    options.network = a.network.empty() ? network_file.filename().string()
                                        : fs::absolute(a.network).lexically_proximate(folder).string();
    return options;
}

int import_scl(ImportArguments const& a) {
    if (a.streams_only) {
        return only_streams(a);
    }
    auto const text = read_whole_scl_file(a.file);
    if (!text) {
        return print_error(text.error());
    }
    auto const document = scl::Document::parse(*text, a.file.string());
    auto station =
        document ? scl::read_station(*document, a.nominal_hz) : Result<scl::Station>{std::unexpected{document.error()}};
    if (!station) {
        return print_error(station.error());
    }
    fs::path const out = a.out.empty() ? fs::path{a.file.stem().string() + ".yaml"} : a.out;
    fs::path const network_file = out.parent_path() / (out.stem().string() + "_network.yaml");
    launcher::StationOptions options = options_of(a, out, network_file);
    int code = 0;
    if (!choose_network(a, options, code)) {
        return code;
    }
    auto const made = launcher::make_scenario(*station, options);
    if (!made) {
        fmt::print(stderr, "{}", launcher::findings_text(station->import.findings, station->import.findings_dropped));
        return print_error(made.error());
    }
    std::string const report = a.json ? launcher::report_json(*station, *made) : launcher::report_text(*station, *made);
    std::size_t const left_out = launcher::count_of(station->import.findings, scl::Finding::Kind::left_out) +
                                 launcher::count_of(made->findings, scl::Finding::Kind::left_out);
    fmt::print("{}", report);
    if (a.strict && left_out > 0) {
        return print_error({ExitCode::usage,
                            fmt::format("{} things were left out, and --strict; nothing was written", left_out),
                            "the report above says where and why"});
    }
    if (auto const written = write_scenario(a, *made, out, network_file); !written) {
        return print_error(written.error());
    }
    std::size_t const processes = made->root.find("processes")->entries.size();
    ScenarioArguments check;
    check.file = out;
    if (processes > kCheckedProcesses) {
        fmt::print(
            stderr,
            "note: {} processes: the scenario was not checked, which takes minutes; `gridspace validate {}` does\n",
            processes, out.string());
    } else if (load(check) == nullptr) { // it has printed why
        return static_cast<int>(ExitCode::usage);
    }
    fmt::print(a.json ? stderr : stdout, "written: {}{}\nrun it: gridspace run {}\n", out.string(),
               a.network.empty() ? " and " + network_file.string() : "", out.string());
    return 0;
}

} // namespace

void add_scl_import(Command scl, Action& action) {
    auto const a = std::make_shared<ImportArguments>();
    Command verb = scl.add_subcommand("import", "make a scenario of an SCD, ICD or CID file");
    verb.add_option("FILE", a->file, "SCL file").required();
    verb.add_option("--ied", a->ieds, "play only this IED; may be given several times").repeated();
    verb.add_option("--nominal-hz", a->nominal_hz, "frequency of the grid, for rates per period (default 50)")
        .check(positive());
    verb.add_option("--network", a->network,
                    "what merging units measure (default: a small network beside the scenario)");
    verb.add_option("--map", a->map,
                    "which transformers of the network an IED measures: YAML, IED: {ct: ..., vt: ...}");
    verb.add_flag("--realtime", a->realtime, "a scenario in real time (default: lockstep)");
    verb.add_flag("--streams-only", a->streams_only, "write only `streams:` (default: to standard output)");
    verb.add_flag("--strict", a->strict, "an error when anything is left out");
    verb.add_flag("--json", a->json, "the report as JSON");
    verb.add_flag("--overwrite", a->overwrite, "replace files that are there already");
    verb.add_option("--out", a->out, "scenario to write (default: the file's name with .yaml)");
    verb.callback([&action, a] { action = [a] { return import_scl(*a); }; });
}

} // namespace gridspace::cli
