// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "sim/network/network_config.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <CLI/CLI.hpp>
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
};

double degrees(sim::Complex v) {
    return std::arg(v) * 180 / std::numbers::pi;
}

std::string branch_name(sim::Network const& n, sim::PowerFlow::BranchValue const& b) {
    return b.kind == sim::TwoPort::Kind::line ? n.lines[b.element].name.name : n.transformers[b.element].name.name;
}

std::pair<std::string, std::string> branch_ends(sim::Network const& n, sim::PowerFlow::BranchValue const& b) {
    if (b.kind == sim::TwoPort::Kind::line) {
        return {n.lines[b.element].from.name, n.lines[b.element].to.name};
    }
    return {n.transformers[b.element].from.name, n.transformers[b.element].to.name};
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
    for (auto const& b : flow.branches) {
        auto const [from, to] = branch_ends(n, b);
        fmt::print("{:<12} {:<10} {:<10} {:>14.4f} {:>14.4f} {:>12.4f}\n", branch_name(n, b), from, to, b.p_from_kw,
                   b.q_from_kvar, b.p_from_kw + b.p_to_kw);
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
    for (auto const& b : flow.branches) {
        auto const [from, to] = branch_ends(n, b);
        branches.push_back({{"name", branch_name(n, b)},
                            {"from", from},
                            {"to", to},
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

int three_phase(sim::Network const& n, bool json) {
    auto const flow = solve_three_phase(n, sim::SwitchState{n});
    if (!flow) {
        return print_error(flow.error());
    }
    auto const branch_of = [&](sim::ThreePhaseFlow::Branch const& b) {
        return b.kind == sim::TwoPort::Kind::line ? n.lines[b.element].name.name : n.transformers[b.element].name.name;
    };
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
    if (arguments.json) {
        fmt::print("{}\n", power_flow_json(*network, *flow).dump(2));
    } else {
        print_power_flow(*network, *flow);
    }
    return 0;
}

} // namespace

void add_powerflow(CLI::App& app, Action& action) {
    auto const a = std::make_shared<PowerFlowArguments>();
    CLI::App* verb = app.add_subcommand("powerflow", "solve the power flow of a network (YAML or MATPOWER)");
    verb->add_option("NETWORK", a->network, "network file")->required();
    verb->add_flag("--json", a->json, "as JSON");
    verb->add_flag("--enforce-q-limits", a->enforce_q_limits,
                   "generators give up their voltage at their reactive limits");
    verb->add_flag("--three-phase", a->three_phase, "unbalanced: voltages and currents by phase");
    verb->callback([a, &action] { action = [a] { return powerflow(*a); }; });
}

} // namespace gridspace::cli
