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

/// Powers of branches and buses; returns what each ideal source behind an impedance delivers to its bus, by node, kVA.
/// What leaves a bus into lines and transformers is what its devices inject; shunts count as devices.
std::vector<Complex> add_branches(PowerFlowProblem const& problem, std::vector<Complex> const& v, double base,
                                  std::size_t buses, PowerFlow& out) {
    std::vector<Complex> into_branches(problem.nodes.size()), from_source(problem.nodes.size());
    for (Branch const& b : problem.branches) {
        Complex const s_from = v[b.from] * std::conj(b.ff * v[b.from] + b.ft * v[b.to]) * base;
        Complex const s_to = v[b.to] * std::conj(b.tf * v[b.from] + b.tt * v[b.to]) * base;
        if (b.element == Branch::kNone) {
            from_source[b.from] = -s_to;
            continue;
        }
        into_branches[b.from] += s_from;
        into_branches[b.to] += s_to;
        out.branches.push_back({b.element, s_from.real(), s_from.imag(), s_to.real(), s_to.imag()});
        out.losses_kw += s_from.real() + s_to.real();
    }
    for (std::size_t i = 0; i < buses; ++i) {
        Complex const shunt = std::conj(problem.shunts[i]) * std::norm(v[i]) * base;
        Complex const net = into_branches[i] + shunt;
        out.buses.push_back({v[i], net.real(), net.imag()});
    }
    return from_source;
}

/// What a bus injects beyond its loads and given powers is shared by those that hold it.
void add_units(PowerFlowProblem const& problem, NewtonOutcome const& solved, std::vector<Complex> const& from_source,
               double base, PowerFlow& out) {
    using Unit = PowerFlowProblem::Unit;
    std::size_t const buses = out.buses.size();
    std::vector<Complex> needed(buses);
    for (std::size_t i = 0; i < buses; ++i) {
        needed[i] = {out.buses[i].p_kw, out.buses[i].q_kvar};
    }
    auto const drawn = [&](PowerFlowProblem::BusLoad const& load) {
        VoltagePower const f = load.load->factor(solved.v[load.node], 0);
        return base * Complex{load.p * f.p, load.q * f.q};
    };
    for (PowerFlowProblem::BusLoad const& load : problem.loads) {
        needed[load.node] += drawn(load);
    }
    // Where a source behind an impedance is: the branch from its node leads to its bus.
    for (Branch const& b : problem.branches) {
        if (b.element == Branch::kNone) {
            needed[b.to] -= from_source[b.from];
        }
    }
    // Given powers are in node.p and node.q together with scheduled ones; what is scheduled is not among them.
    std::vector<double> holders(buses, 0);
    std::vector<Complex> scheduled(buses);
    for (Unit const& unit : problem.units) {
        if (unit.holds != Unit::Holds::nothing && unit.node < buses) {
            holders[unit.node] += 1;
            scheduled[unit.node] += unit.kva.real();
        }
    }
    for (Unit const& unit : problem.units) {
        std::size_t const i = unit.node;
        Complex given = unit.admittance ? unit.kva * solved.v[i] * solved.v[i] : unit.kva;
        if (unit.load) {
            given -= drawn(problem.loads[*unit.load]);
        }
        if (unit.holds != Unit::Holds::nothing && i >= buses) {
            given = from_source[i];
        } else if (unit.holds != Unit::Holds::nothing) {
            PowerFlowProblem::Node const& node = problem.nodes[i];
            Complex const fixed{node.p * base - scheduled[i].real(), node.q * base};
            Complex const rest = needed[i] - fixed;
            double const p = unit.kva.real(), beyond = rest.real() - scheduled[i].real();
            bool const has_schedule = unit.holds == Unit::Holds::power_and_voltage;
            double const own = !has_schedule ? beyond : node.kind == NodeKind::slack ? p + beyond / holders[i] : p;
            given = {own, rest.imag() / holders[i]};
        }
        out.units.push_back({given.real(), given.imag()});
    }
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
    std::vector<Complex> const from_source = add_branches(problem, v, base, n.buses.size(), out);
    add_units(problem, solved, from_source, base, out);
    return out;
}

} // namespace gridspace::sim
