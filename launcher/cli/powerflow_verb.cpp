// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/powerflow_dss.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/folder/write_file.hpp"
#include "sim/network/network_config.hpp"
#include "sim/opendss/opendss_file.hpp"
#include "sim/powerflow/matpower_export.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct PowerFlowArguments {
    std::filesystem::path network;
    bool json{false}, enforce_q_limits{false}, three_phase{false};
    std::string branches_csv, matpower;
    DssArguments dss; ///< what only OpenDSS scripts have, and --csv
};

double degrees(sim::Complex v) {
    return std::arg(v) * 180 / std::numbers::pi;
}

void print_power_flow(sim::Network const& n, sim::PowerFlow const& flow) {
    fmt::print("{}: converged in {} iterations, largest mismatch {:.1e} p.u.\n\n", n.name, flow.iterations,
               flow.mismatch_pu);
    fmt::print("{:<12} {:>10} {:>11} {:>14} {:>14}\n", "bus", "v, p.u.", "angle, deg", "p, kW", "q, kvar");
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        auto const& b = flow.buses[i];
        fmt::print("{:<12} {:>10.6f} {:>11.5f} {:>14.4f} {:>14.4f}\n", n.buses[i].name.name, std::abs(b.v),
                   degrees(b.v), b.p_kw, b.q_kvar);
    }
    fmt::print("\n{:<12} {:<10} {:<10} {:>14} {:>14} {:>12}\n", "branch", "from", "to", "p from, kW", "q from, kvar",
               "loss, kW");
    auto const elements = two_ports(n);
    for (auto const& b : flow.branches) {
        sim::TwoPort const& e = *elements[b.element];
        fmt::print("{:<12} {:<10} {:<10} {:>14.4f} {:>14.4f} {:>12.4f}\n", e.name.name, e.from.name, e.to.name,
                   b.p_from_kw, b.q_from_kvar, b.p_from_kw + b.p_to_kw);
    }
    fmt::print("\nlosses {:.4f} kW; p and q of a bus are its net injection (generation minus load)\n", flow.losses_kw);
}

Json power_flow_json(sim::Network const& n, sim::PowerFlow const& flow) {
    Json buses = Json::array(), branches = Json::array();
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        auto const& b = flow.buses[i];
        buses.push_back({{"name", n.buses[i].name.name},
                         {"v_pu", std::abs(b.v)},
                         {"angle_deg", degrees(b.v)},
                         {"p_mw", b.p_kw / 1e3},
                         {"q_mvar", b.q_kvar / 1e3}});
    }
    auto const elements = two_ports(n);
    for (auto const& b : flow.branches) {
        sim::TwoPort const& e = *elements[b.element];
        branches.push_back({{"name", e.name.name},
                            {"from", e.from.name},
                            {"to", e.to.name},
                            {"p_from_mw", b.p_from_kw / 1e3},
                            {"q_from_mvar", b.q_from_kvar / 1e3},
                            {"p_to_mw", b.p_to_kw / 1e3},
                            {"q_to_mvar", b.q_to_kvar / 1e3},
                            {"loss_mw", (b.p_from_kw + b.p_to_kw) / 1e3}});
    }
    return {{"converged", true},    {"iterations", flow.iterations}, {"mismatch_pu", flow.mismatch_pu},
            {"buses", buses},       {"branches", branches},          {"losses_mw", flow.losses_kw / 1e3},
            {"doubts", flow.doubts}};
}

std::string buses_csv(sim::Network const& n, sim::PowerFlow const& flow) {
    std::string out = "bus,v_pu,angle_deg,p_kw,q_kvar\n";
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        auto const& b = flow.buses[i];
        out += fmt::format("{},{},{},{},{}\n", n.buses[i].name.name, shortest(std::abs(b.v)), shortest(degrees(b.v)),
                           shortest(b.p_kw), shortest(b.q_kvar));
    }
    return out;
}

std::string branches_csv(sim::Network const& n, sim::PowerFlow const& flow) {
    std::string out = "branch,from,to,p_from_kw,q_from_kvar,p_to_kw,q_to_kvar\n";
    auto const elements = two_ports(n);
    for (auto const& b : flow.branches) {
        sim::TwoPort const& e = *elements[b.element];
        out += fmt::format("{},{},{},{},{},{},{}\n", e.name.name, e.from.name, e.to.name, shortest(b.p_from_kw),
                           shortest(b.q_from_kvar), shortest(b.p_to_kw), shortest(b.q_to_kvar));
    }
    return out;
}

/// Into the files that were asked for.
Result<void> write_files(PowerFlowArguments const& a, sim::Network const& n, sim::PowerFlowOptions const& options,
                         sim::PowerFlow const& flow) {
    Result<void> ok;
    if (!a.dss.csv.empty()) {
        ok = launcher::write_file(a.dss.csv, buses_csv(n, flow));
    }
    if (ok && !a.branches_csv.empty()) {
        ok = launcher::write_file(a.branches_csv, branches_csv(n, flow));
    }
    if (ok && !a.matpower.empty()) {
        ok = launcher::write_file(a.matpower, to_matpower(n, sim::SwitchState{n}, options, flow));
    }
    return ok;
}

int three_phase(sim::Network const& n, bool json) {
    auto const flow = solve_three_phase(n, sim::SwitchState{n});
    if (!flow) {
        return print_error(flow.error());
    }
    auto const elements = two_ports(n);
    auto const branch_of = [&](sim::ThreePhaseFlow::Branch const& b) { return elements[b.element]->name.name; };
    if (json) {
        auto const values = [](sim::Phases const& p) {
            Json out = Json::array();
            for (sim::Complex const x : p) {
                out.push_back({std::abs(x), degrees(x)});
            }
            return out;
        };
        Json buses = Json::array(), branches = Json::array();
        for (std::size_t i = 0; i < n.buses.size(); ++i) {
            buses.push_back({{"name", n.buses[i].name.name}, {"v_v_deg", values(flow->buses[i])}});
        }
        for (auto const& b : flow->branches) {
            branches.push_back({{"name", branch_of(b)}, {"from_a_deg", values(b.from)}, {"to_a_deg", values(b.to)}});
        }
        fmt::print(
            "{}\n",
            Json{{"converged", true}, {"iterations", flow->iterations}, {"buses", buses}, {"branches", branches}}.dump(
                2));
        return 0;
    }
    auto const row = [](std::string const& name, sim::Phases const& p) {
        fmt::print("{:<20} {:>10.2f} {:>8.2f} {:>10.2f} {:>8.2f} {:>10.2f} {:>8.2f}\n", name, std::abs(p[0]),
                   degrees(p[0]), std::abs(p[1]), degrees(p[1]), std::abs(p[2]), degrees(p[2]));
    };
    fmt::print("{}: converged in {} iterations\n\n{:<20} {:>10} {:>8} {:>10} {:>8} {:>10} {:>8}\n", n.name,
               flow->iterations, "bus (to earth)", "a, V", "deg", "b, V", "deg", "c, V", "deg");
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        row(n.buses[i].name.name, flow->buses[i]);
    }
    fmt::print("\n{:<20} {:>10} {:>8} {:>10} {:>8} {:>10} {:>8}\n", "current into", "a, A", "deg", "b, A", "deg",
               "c, A", "deg");
    for (auto const& b : flow->branches) {
        row(branch_of(b) + ", from", b.from);
        row(branch_of(b) + ", to", b.to);
    }
    return 0;
}

int powerflow(PowerFlowArguments const& arguments) {
    DssArguments dss = arguments.dss;
    bool const files = !arguments.branches_csv.empty() || !arguments.matpower.empty();
    if (opendss::is_script(arguments.network)) {
        if (files) {
            return print_error({ExitCode::usage,
                                "--branches-csv and --matpower are not for OpenDSS scripts: they are by phase",
                                "--csv writes the voltages of all nodes"});
        }
        dss.script = arguments.network;
        dss.json = arguments.json;
        return powerflow_dss(dss);
    }
    if (!dss.include.empty() || !dss.commands.empty() || dss.hour) {
        return print_error({ExitCode::usage, "--include, --command and --hour are for OpenDSS scripts (.dss)", ""});
    }
    if (arguments.three_phase && (files || !dss.csv.empty())) {
        return print_error({ExitCode::usage, "--csv, --branches-csv and --matpower write the balanced power flow",
                            "leave out --three-phase, or take its --json"});
    }
    config::Diagnostics diagnostics;
    auto const network = sim::load_network(arguments.network, diagnostics);
    if (!network) {
        fmt::print(stderr, "{}\n", diagnostics.render());
        return static_cast<int>(ExitCode::usage);
    }
    if (arguments.three_phase) {
        return three_phase(*network, arguments.json);
    }
    if (is_unbalanced(*network)) {
        fmt::print(stderr, "note: this network is not balanced, and this is the balanced power flow: lines transposed, "
                           "a third of each load per phase (see --three-phase)\n");
    }
    sim::PowerFlowOptions options;
    options.enforce_q_limits = arguments.enforce_q_limits;
    auto const flow = solve_power_flow(*network, sim::SwitchState{*network}, options);
    for (std::size_t i = 0; flow && i < flow->doubts.size(); ++i) {
        fmt::print(stderr, "warning: hard to believe: {}\n", flow->doubts[i]);
    }
    if (!flow) {
        if (arguments.json) {
            fmt::print(
                "{}\n",
                Json{{"converged", false}, {"message", flow.error().message}, {"hint", flow.error().remedy}}.dump(2));
        }
        return print_error(flow.error());
    }
    if (auto const ok = write_files(arguments, *network, options, *flow); !ok) {
        return print_error(ok.error());
    }
    if (arguments.json) {
        fmt::print("{}\n", power_flow_json(*network, *flow).dump(2));
    } else {
        print_power_flow(*network, *flow);
    }
    return 0;
}

} // namespace

void add_powerflow(Command app, Action& action) {
    auto const a = std::make_shared<PowerFlowArguments>();
    Command verb = app.add_subcommand("powerflow", "solve the power flow of a network (YAML, MATPOWER or OpenDSS)");
    verb.add_option("NETWORK", a->network, "network file (YAML, MATPOWER or OpenDSS)").required();
    verb.add_flag("--json", a->json, "as JSON");
    verb.add_flag("--enforce-q-limits", a->enforce_q_limits,
                  "generators give up their voltage at their reactive limits");
    verb.add_flag("--three-phase", a->three_phase, "unbalanced: voltages and currents by phase");
    verb.add_option("--csv", a->dss.csv, "a table of the buses; of an OpenDSS script: of all nodes");
    verb.add_option("--branches-csv", a->branches_csv, "a table of the flows in the branches");
    verb.add_option("--matpower", a->matpower, "network and solution as a MATPOWER case (.m)");
    verb.add_option("--include", a->dss.include, "OpenDSS: a folder from which the script may read, too");
    verb.add_option("--command", a->dss.commands, "OpenDSS: a command to carry out after the script").repeated();
    verb.add_option("--hour", a->dss.hour, "OpenDSS: at which daily load shapes are read");
    verb.callback([a, &action] { action = [a] { return powerflow(*a); }; });
}

} // namespace gridspace::cli
