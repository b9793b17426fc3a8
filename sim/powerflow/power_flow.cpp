// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/power_flow.hpp"

#include "sim/powerflow/search.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {
namespace {

std::string node_name(Network const& n, std::size_t node) {
    return node < n.buses.size() ? fmt::format("bus '{}'", n.buses[node].name.name) : "the inside of a source";
}

/// Four digits in the unit in which they are read most easily.
std::string apparent_power(double kva) {
    if (kva >= 1e7) {
        return fmt::format("{:.4g} GVA", kva * 1e-6);
    }
    if (kva >= 1e4) {
        return fmt::format("{:.4g} MVA", kva * 1e-3);
    }
    return kva < 1 ? fmt::format("{:.4g} VA", kva * 1e3) : fmt::format("{:.4g} kVA", kva);
}

/// What is known where there is no solution: the power that does not balance, and how much of all powers still has a
/// solution.
Error explain(Network const& n, PowerFlowProblem const& problem, SearchOutcome const& found) {
    NewtonOutcome const& failed = found.solution;
    if (!std::isfinite(failed.mismatch)) {
        return {ExitCode::usage,
                fmt::format("the power flow has no solution in numbers: at {} they overflow",
                            node_name(n, failed.worst_node)),
                "look for an extreme impedance, rating or power near that bus"};
    }
    std::string message = fmt::format("the power flow {} after {} iterations: at {} {} do not balance",
                                      failed.singular ? "is singular" : "does not converge", failed.iterations,
                                      node_name(n, failed.worst_node), apparent_power(failed.mismatch * n.power_kva));
    if (found.v_reached.empty()) {
        return {ExitCode::usage, message + ", nor without any load", ""};
    }
    std::size_t weakest = n.buses.size();
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        if (problem.nodes[i].kind != NodeKind::dead &&
            (weakest == n.buses.size() || found.v_reached[i] < found.v_reached[weakest])) {
            weakest = i;
        }
    }
    return {ExitCode::usage, std::move(message),
            fmt::format("it has a solution up to {:.0f} % of all powers, where {} is lowest at {:.3f} p.u.",
                        std::floor(found.reached * 100), node_name(n, weakest), found.v_reached[weakest])};
}

} // namespace

Result<PowerFlow> solve_power_flow(Network const& n, SwitchState const& state, PowerFlowOptions const& options) {
    PowerFlowProblem const problem = make_problem(n, state, options);
    SearchOutcome const found = search(n, problem, options);
    NewtonOutcome const& solved = found.solution;
    if (!solved.converged) {
        return std::unexpected{explain(n, problem, found)};
    }
    double const base = n.power_kva;
    PowerFlow out;
    out.doubts = found.doubts;
    out.iterations = solved.iterations;
    out.mismatch_pu = solved.mismatch;
    std::vector<Complex> v;
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        v.push_back(std::polar(solved.v[i], solved.angle[i]));
    }
    // What leaves each bus into lines and transformers is what its devices inject; shunts count as devices.
    std::vector<Complex> into_branches(problem.nodes.size());
    std::vector<Complex> from_source(problem.nodes.size());
    std::size_t const own_branches = two_ports(n, state).size();
    for (std::size_t i = 0; i < problem.branches.size(); ++i) {
        TwoPort const& b = problem.branches[i];
        Complex const s_from = v[b.from] * std::conj(b.ff * v[b.from] + b.ft * v[b.to]) * base;
        Complex const s_to = v[b.to] * std::conj(b.tf * v[b.from] + b.tt * v[b.to]) * base;
        if (i >= own_branches) {
            from_source[b.from] = -s_to; // what a source delivers to its bus
            continue;
        }
        into_branches[b.from] += s_from;
        into_branches[b.to] += s_to;
        out.branches.push_back({b.kind, b.element, s_from.real(), s_from.imag(), s_to.real(), s_to.imag()});
        out.losses_kw += s_from.real() + s_to.real();
    }
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        Complex const shunt = std::conj(problem.shunts[i]) * std::norm(v[i]) * base;
        Complex const net = into_branches[i] + shunt;
        out.buses.push_back({v[i], net.real(), net.imag()});
    }
    // Units: what a bus injects beyond its loads and fixed injections is shared by the units that hold it.
    NameIndex const buses{n.buses};
    std::vector<Complex> needed(n.buses.size());
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        needed[i] = {out.buses[i].p_kw, out.buses[i].q_kvar};
    }
    for (PowerFlowProblem::BusLoad const& load : problem.loads) {
        VoltagePower const f = load.load->factor(solved.v[load.node], 0);
        needed[load.node] += base * Complex{load.p * f.p, load.q * f.q};
    }
    for (std::size_t s = 0; s < n.sources.size(); ++s) {
        std::size_t const node = problem.source_node[s];
        Complex const delivered = node >= n.buses.size() ? from_source[node] : Complex{};
        out.sources.push_back({delivered.real(), delivered.imag()});
        if (node >= n.buses.size()) {
            needed[buses[n.sources[s].bus.name]] -= delivered;
        }
    }
    // Fixed injections (PV inverters, PQ generators) are in node.p and node.q together with scheduled powers; take what
    // is not a unit's own away.
    std::vector<double> holders(n.buses.size(), 0);
    std::vector<Complex> scheduled(n.buses.size());
    auto const count = [&](Ref const& bus, double p) {
        holders[buses[bus.name]] += 1;
        scheduled[buses[bus.name]] += p;
    };
    for (Generator const& g : n.generators) {
        if (g.role != GeneratorRole::pq) {
            count(g.bus, g.role == GeneratorRole::slack ? 0 : g.p_kw);
        }
    }
    for (Machine const& m : n.machines) {
        count(m.bus, m.p_kw);
    }
    auto const share = [&](Ref const& bus, double p, bool scheduled_p) -> PowerFlow::UnitValue {
        std::size_t const i = buses[bus.name];
        PowerFlowProblem::Node const& node = problem.nodes[i];
        Complex const fixed{node.p * base - scheduled[i].real(), node.q * base};
        Complex const rest = needed[i] - fixed;
        double const own_p = node.kind == NodeKind::slack || !scheduled_p
                                 ? (scheduled_p ? p + (rest.real() - scheduled[i].real()) / holders[i]
                                                : rest.real() - scheduled[i].real())
                                 : p;
        return {own_p, rest.imag() / holders[i]};
    };
    for (Generator const& g : n.generators) {
        if (g.role == GeneratorRole::pq) {
            out.generators.push_back({g.p_kw, g.q_kvar});
        } else {
            out.generators.push_back(share(g.bus, g.p_kw, g.role == GeneratorRole::pv));
        }
    }
    for (Machine const& m : n.machines) {
        out.machines.push_back(share(m.bus, m.p_kw, true));
    }
    return out;
}

} // namespace gridspace::sim
