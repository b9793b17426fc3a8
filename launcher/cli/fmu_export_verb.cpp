// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace fmu export`: a network as an FMU for other tools.
#include "common/time.hpp"
#include "launcher/cli/engine_options.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/fmu/grid_fmu.hpp"
#include "launcher/fmu/network_files.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/scenario/installation.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"
#include "sim/solvers/make_engine.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <memory>

namespace gridspace::cli {
namespace {

struct FmuExportArguments {
    std::filesystem::path network, out;
    EngineOptions engine;
    std::string epoch;
    std::vector<std::string> signals, inputs; ///< patterns; empty: the usual ones, and all
};

Result<std::string> read_library() {
    std::filesystem::path const file = launcher::grid_library();
    std::ifstream in{file, std::ios::binary};
    std::string octets{std::istreambuf_iterator<char>{in}, {}};
    if (!in || octets.empty()) {
        return fail(ExitCode::environment, fmt::format("cannot read the library that runs networks, {}", file.string()),
                    "it is built and installed with gridspace: is this installation complete?");
    }
    return octets;
}

template <class T>
std::vector<T> at(std::vector<T> const& all, std::vector<std::size_t> const& places) {
    std::vector<T> out;
    for (std::size_t const place : places) {
        out.push_back(all[place]);
    }
    return out;
}

/// Inputs and outputs that were asked for, of a network that has been seen to start.
Result<void> choose_variables(FmuExportArguments const& a, sim::Network const& network, launcher::GridToExport& grid) {
    auto engine = sim::make_engine(grid.engine, network, TimeBase{grid.engine.step_s});
    auto const started = engine ? (*engine)->initialise() : Result<void>{std::unexpected{engine.error()}};
    if (!started) {
        return started;
    }
    std::vector<sim::SignalDef> const& signals = (*engine)->signals();
    // The usual ones are what somebody who couples a grid to something else wants to see of it.
    auto const outputs =
        choose(names_of(signals), a.signals,
               {"bus.*.v_pu", "bus.*.frequency_hz", "*.p_kw", "*.q_kvar", "*.position", "*.soc_percent", "system.*"},
               "signal", "`gridspace simulate NETWORK --list-signals` shows what there is");
    if (!outputs) {
        return std::unexpected{outputs.error()};
    }
    std::vector<sim::GridInput> const all = sim::grid_inputs(network, grid.engine.waveform());
    std::vector<std::string> names;
    for (sim::GridInput const& input : all) {
        names.push_back(input.name);
    }
    auto const inputs = choose(names, a.inputs, {"*"}, "input", "`gridspace fmu info` of an FMU with all shows them");
    if (!inputs) {
        return std::unexpected{inputs.error()};
    }
    grid.outputs = at(signals, *outputs);
    grid.inputs = at(all, *inputs);
    return {};
}

int export_fmu(FmuExportArguments const& a) {
    auto const chosen = chosen_engine(a.engine);
    if (!chosen) {
        return print_error(chosen.error());
    }
    launcher::GridToExport grid;
    grid.engine = chosen->settings;
    grid.stop_s = chosen->until_s;
    if (!a.epoch.empty()) {
        grid.engine.epoch = a.epoch;
    }
    if (!parse_utc(grid.engine.epoch)) {
        return print_error({ExitCode::usage, fmt::format("--epoch '{}' is not a UTC time from 1970 to 2199", a.epoch),
                            "for example 2019-12-01T09:00:00Z"});
    }
    if (auto ok = launcher::check_writable(a.out); !ok) {
        return print_error(ok.error());
    }
    config::Diagnostics diagnostics;
    auto const network = sim::load_network(a.network, diagnostics);
    auto files = network ? launcher::network_files(a.network, diagnostics) : std::nullopt;
    if (!files) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    grid.name = network->name;
    grid.files = std::move(*files);
    settle_step(grid.engine, *network, false);
    for (std::string const& unseen :
         grid.engine.waveform() ? std::vector<std::string>{} : sim::phasor::unseen_by_phasors(*network)) {
        fmt::print(stderr, "note: {} (--solver emt does)\n", unseen);
    }
    if (auto ok = choose_variables(a, *network, grid); !ok) {
        return print_error(ok.error());
    }
    auto binary = read_library();
    if (!binary) {
        return print_error(binary.error());
    }
    grid.binary = std::move(*binary);
    auto const octets = launcher::make_grid_fmu(grid);
    auto const written = octets ? launcher::replace_file(a.out, *octets) : std::unexpected{octets.error()};
    if (!written) {
        return print_error(written.error());
    }
    fmt::print("{}: FMI 3.0 for co-simulation, {} in steps of {} s, {} inputs, {} outputs\n", a.out.string(),
               grid.engine.waveform() ? "waveforms" : "phasors", grid.engine.step_s.to_string(), grid.inputs.size(),
               grid.outputs.size());
    return 0;
}

} // namespace

void add_fmu_export(Command fmu, Action& action) {
    auto const a = std::make_shared<FmuExportArguments>();
    Command verb = fmu.add_subcommand("export", "a network as an FMU 3.0 for co-simulation: set-points and commands go "
                                                "in, signals come out");
    verb.add_option("NETWORK", a->network, "network file (YAML or MATPOWER)").required();
    verb.add_option("-o,--out", a->out, "the FMU to write").required();
    engine_options(verb, a->engine);
    verb.add_option("--epoch", a->epoch, "UTC of time 0, for profiles by the hour of the day");
    verb.add_option("--signals", a->signals, "outputs: names or patterns, separated by commas").delimiter(',');
    verb.add_option("--inputs", a->inputs, "inputs: names or patterns, separated by commas (default: all)")
        .delimiter(',');
    verb.callback([a, &action] { action = [a] { return export_fmu(*a); }; });
}

} // namespace gridspace::cli
