// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/help.hpp"

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::cli {
namespace {

/// For each verb a line with its name, then examples, indented. `tests/lint` looks whether their verbs, options and
/// files are there.
constexpr std::string_view kExamples = R"(
gridspace run
    gridspace run configs/scenarios/ev_charging.yaml
    gridspace run configs/scenarios/ev_charging.yaml --set processes.ev1.requested_h=5 --out runs/mine
    gridspace run configs/scenarios/protection_lockstep.yaml --until 6s --dry-run
gridspace sweep
    gridspace sweep configs/studies/ev_requested_times.yaml --dry-run
    gridspace sweep configs/studies/ev_requested_times.yaml --jobs 2
gridspace certify
    gridspace certify configs/certify/feeder_distance.yaml --dry-run
    gridspace certify configs/certify/feeder_distance.yaml --samples 250 --out runs/thousand
gridspace timebox
    gridspace timebox --trace -- sleep 10
gridspace validate
    gridspace validate configs/scenarios/ev_charging.yaml configs/networks/ev_microgrid.yaml
gridspace signals
    gridspace signals configs/scenarios/ev_charging.yaml
gridspace powerflow
    gridspace powerflow configs/networks/ev_microgrid.yaml
    gridspace powerflow tests/golden/powerflow/case9.m --json
    gridspace powerflow configs/networks/adn_set_a.yaml --matpower adn.m --csv buses.csv
gridspace simulate
    gridspace simulate configs/networks/adn_set_a.yaml --until 0.1s --csv waveforms.csv
    gridspace simulate configs/networks/adn_set_a.yaml --list-signals
gridspace compare
    gridspace compare runs/first runs/second
    gridspace compare runs/first runs/second --signals 'bus.*.v_pu' --tolerance 0.001
gridspace report
    gridspace report latest
gridspace info
    gridspace info latest
gridspace export
    gridspace export latest
    gridspace export latest --comtrade --trigger relay2.trip --before-ms 200 --after-ms 500
gridspace ids train
    gridspace ids train configs/ids/ar_20.yaml --out mine.json
gridspace ids evaluate
    gridspace ids evaluate configs/models/ar_20.json configs/ids/ar_20.yaml
gridspace ids study
    gridspace ids study configs/ids/mlp_20_10_1.yaml --windows 10,20 --hidden 5,10 --out study
gridspace ids scan
    gridspace ids scan capture.pcapng
    gridspace ids scan runs/latest/bus.pcapng.gz --streams configs/scenarios/protection.yaml --line SMV21,SMV22 --out scan
gridspace ids score
    gridspace ids score latest verdicts.csv
gridspace ids export
    gridspace ids export runs/study-attacks --out dataset
gridspace monitor
    gridspace monitor latest
    gridspace monitor --domain 7 --address 192.168.1.20
gridspace keys init
    gridspace keys init keys
    gridspace keys init keys relay2 ev1 --days 30
gridspace keys issue
    gridspace keys issue keys relay2 --days 30
gridspace keys revoke
    gridspace keys revoke keys relay2
gridspace keys list
    gridspace keys list keys
gridspace ids sweep
    gridspace ids sweep
    gridspace ids sweep configs/studies/ids_benchmark.yaml --keep
gridspace router
    gridspace router plant.yaml --check
    gridspace router plant.yaml
gridspace graph
    gridspace graph
    gridspace graph latest --svg > graph.svg
gridspace topic list
    gridspace topic list
gridspace topic info
    gridspace topic info bus_measurements
gridspace topic echo
    gridspace topic echo bus_measurements
gridspace topic hz
    gridspace topic hz bus_measurements
gridspace pause
    gridspace pause
gridspace continue
    gridspace continue
gridspace step
    gridspace step --ticks 10
gridspace stop
    gridspace stop latest
gridspace doctor
    gridspace doctor
    gridspace doctor --latency --seconds 10
gridspace bundle
    gridspace bundle configs/scenarios/protection_lockstep.yaml relay2 --arch arm64
gridspace play
    gridspace play latest --rate 10 --topics 'bus_*'
    gridspace play latest --dashboard
gridspace wire list
    gridspace wire list eth1
gridspace wire sv-pub
    gridspace wire sv-pub eth1 sv_id=MU21 app_id=0x4021 data_set=9-2LE
gridspace wire sv-sub
    gridspace wire sv-sub eth1 sv_id=MU21
gridspace wire goose-pub
    gridspace wire goose-pub eth1 'control_block=IED2LD0/LLN0$GO$Trip' 'data_set={trip: boolean}' --value trip=true
gridspace wire goose-sub
    gridspace wire goose-sub eth1 --file configs/scenarios/protection.yaml --stream TRIP2
gridspace wire replay
    gridspace wire replay runs/latest/bus.pcapng.gz veth0
gridspace wire stats
    gridspace wire stats runs/latest/bus.pcapng.gz
gridspace scl import
    gridspace scl import station.scd --out station.yaml
    gridspace scl import station.scd --network grid.yaml --map measured.yaml --realtime
gridspace scl export
    gridspace scl export configs/scenarios/protection.yaml --out protection.cid
gridspace fmu info
    gridspace fmu info heat_pump.fmu
gridspace fmu export
    gridspace fmu export configs/networks/house.yaml --solver phasor --step 1 --out house.fmu
    gridspace fmu export grid.yaml --signals 'bus.*.v_pu,line.*.i_a' --inputs 'set_point.battery.*' --out grid.fmu
gridspace new agent
    gridspace new agent my_agent
    gridspace new agent my_agent --language c++
gridspace new scenario
    gridspace new scenario my_scenario
gridspace new network
    gridspace new network my_grid
gridspace types
    gridspace types > gridspace_types.h
gridspace completion
    source <(gridspace completion bash)
)";

constexpr std::string_view kFirst = R"(Gridspace: smart-grid co-simulation over DDS and IEC 61850

    gridspace run configs/scenarios/ev_charging.yaml      # a first scenario: eight hours in about ten seconds

Every day
  run SCENARIO               run it, record it, judge it, report it
  validate FILE              all mistakes of a scenario, network, study or case at once
  monitor RUN                the dashboard on a finished run; RUN is a folder of runs/, or latest
  compare RUN_A RUN_B        identical, or where they first differ
  export RUN                 tables (CSV) or disturbance records (COMTRADE)
  powerflow NETWORK          the power flow of a network
  new agent NAME             an agent of your own that runs at once
  doctor                     what this machine allows, and what helps

`gridspace --help` lists all verbs, `gridspace VERB --help` the options of one.
)";

/// "gridspace wire list"
std::string path_of(CLI::App const* app) {
    std::string path = app->get_name();
    for (CLI::App const* parent = app->get_parent(); parent != nullptr; parent = parent->get_parent()) {
        path = parent->get_name() + " " + path;
    }
    return path;
}

/// The indented lines behind the line that is `path`; empty when there is none.
std::string_view examples_of(std::string const& path) {
    std::string const line = "\n" + path + "\n";
    std::size_t const found = kExamples.find(line);
    if (found == std::string_view::npos) {
        return {};
    }
    std::size_t const begin = found + line.size();
    std::size_t end = begin;
    while (kExamples.substr(end).starts_with("    ")) {
        end = kExamples.find('\n', end) + 1;
    }
    return kExamples.substr(begin, end - begin);
}

class HelpFormatter final : public CLI::Formatter {
  public:
    HelpFormatter() {
        label("Positionals", "Arguments");
        label("OPTIONS", "options");
        label("SUBCOMMAND", "VERB");
    }

    std::string make_help(CLI::App const* app, std::string name, CLI::AppFormatMode mode) const override {
        std::string text = Formatter::make_help(app, std::move(name), mode);
        for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != std::string::npos;) {
            text.erase(at, 1); // the library parts groups by two empty lines
        }
        return text;
    }

    std::string make_usage(CLI::App const* app, std::string name) const override {
        std::string_view const examples = examples_of(path_of(app));
        return (examples.empty() ? std::string{} : "\n" + std::string{examples} + "\n") +
               Formatter::make_usage(app, std::move(name));
    }

    /// Without the options for help itself: who reads this has found them.
    std::string make_group(std::string group, bool is_positional,
                           std::vector<CLI::Option const*> options) const override {
        std::erase_if(options, [](CLI::Option const* option) {
            return option->check_lname("help") || option->check_lname("help-all");
        });
        return options.empty() ? std::string{} : Formatter::make_group(std::move(group), is_positional, options);
    }

    /// "TEXT", "{debug,info}" or, of flags and arguments, nothing.
    std::string make_option_opts(CLI::Option const* option) const override {
        if (option->get_type_size() == 0 || option->get_positional()) {
            return {};
        }
        std::string const type = option->get_type_name(); // "INT:INT in [0 - 232]", "TEXT:{debug,info}"
        std::size_t const choices = type.find('{');
        return " " + (choices == std::string::npos ? type.substr(0, type.find(':')) : type.substr(choices));
    }
};

} // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() {
    return std::make_shared<HelpFormatter>();
}

std::string_view first_help() {
    return kFirst;
}

} // namespace gridspace::cli
