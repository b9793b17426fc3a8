// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/problem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// Gives every island a node that holds the angle, and marks nodes without any source of voltage as dead.
void hold_angles(Network const& network, PowerFlowProblem& problem) {
    std::size_t const n = problem.nodes.size();
    std::vector<std::size_t> island(n);
    for (std::size_t i = 0; i < n; ++i) {
        island[i] = i;
    }
    auto const top = [&](std::size_t i) {
        while (island[i] != i) {
            i = island[i] = island[island[i]];
        }
        return i;
    };
    for (TwoPort const& b : problem.branches) {
        if (b.ft != Complex{} || b.tf != Complex{}) {
            island[top(b.from)] = top(b.to);
        }
    }
    std::vector<bool> held(n, false);
    for (std::size_t i = 0; i < n; ++i) {
        if (problem.nodes[i].kind == NodeKind::slack) {
            held[top(i)] = true;
        }
    }
    // The largest machine first, the first of equals.
    std::vector<std::size_t> order;
    for (std::size_t m = 0; m < network.machines.size(); ++m) {
        order.push_back(m);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return network.machines[a].rating_kva > network.machines[b].rating_kva;
    });
    for (std::size_t const m : order) {
        std::size_t const node = index_of(network.buses, network.machines[m].bus.name);
        if (!held[top(node)]) {
            problem.nodes[node].kind = NodeKind::slack;
            held[top(node)] = true;
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (!held[top(i)]) {
            problem.nodes[i].kind = NodeKind::dead;
            problem.nodes[i].v = 0;
        }
    }
}

/// Begins the iteration with the angles of the network without load, from the nodes that hold theirs outwards: from
/// angles that are far away Newton's method finds no way.
void start_angles(PowerFlowProblem& problem) {
    std::vector<std::vector<std::pair<std::size_t, double>>> next(problem.nodes.size());
    for (TwoPort const& b : problem.branches) {
        if (b.ft != Complex{} && b.tf != Complex{}) {
            double const turn = lead_of(b);
            next[b.from].emplace_back(b.to, turn);
            next[b.to].emplace_back(b.from, -turn);
        }
    }
    std::vector<std::size_t> reached;
    std::vector<bool> known(problem.nodes.size(), false);
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        if (problem.nodes[i].kind == NodeKind::slack) {
            known[i] = true;
            reached.push_back(i);
        }
    }
    for (std::size_t k = 0; k < reached.size(); ++k) { // grows
        std::size_t const from = reached[k];
        for (auto const& [to, turn] : next[from]) {
            if (!known[to]) {
                known[to] = true;
                problem.nodes[to].angle = problem.nodes[from].angle + turn;
                reached.push_back(to);
            }
        }
    }
}

/// The solution that came with the network, where every live bus has one; whose voltage is held begins with the held
/// one.
void given_start(Network const& network, PowerFlowProblem& problem) {
    PowerFlowStart start;
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        PowerFlowProblem::Node const& node = problem.nodes[i];
        bool const live = node.kind != NodeKind::dead;
        if (live && (i >= network.buses.size() || !network.buses[i].start || network.buses[i].start->v_pu <= 0)) {
            return;
        }
        bool const free = node.kind == NodeKind::pq;
        start.v.push_back(free ? network.buses[i].start->v_pu : node.v);
        start.angle.push_back(free || node.kind == NodeKind::pv ? network.buses[i].start->angle_deg * kDegree
                                                                : node.angle);
    }
    problem.given = std::move(start);
}

/// Puts elements into the problem.
class Filler final : public PowerFlowFace {
  public:
    Filler(Network const& n, PowerFlowOptions const& options, PowerFlowProblem& problem)
        : n_{n}, options_{options}, problem_{problem}, buses_{n.buses} {}
    void inject(Ref const& bus, Complex kva) override {
        PowerFlowProblem::Node& node = problem_.nodes[buses_[bus.name]];
        node.p += kva.real() / n_.power_kva;
        node.q += kva.imag() / n_.power_kva;
    }
    void admit(Ref const& bus, Complex kva) override { problem_.shunts[buses_[bus.name]] += kva / n_.power_kva; }
    void draw(Ref const& bus, VoltageDependent const& load, double scale) override {
        double const k = scale / n_.power_kva;
        Complex const nominal = load.nominal_kva();
        problem_.loads.push_back({buses_[bus.name], &load, nominal.real() * k, nominal.imag() * k});
    }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return n_.buses[buses_[bus.name]].voltage_v; }
    [[nodiscard]] double scale(Ref const& profile) const override {
        Profile const* p = find(n_.profiles, profile.name);
        return p == nullptr ? 1.0 : profile_value(*p, options_.hours, options_.start_hour_of_day);
    }

  private:
    Network const& n_;
    PowerFlowOptions const& options_;
    PowerFlowProblem& problem_;
    NameIndex buses_;
};

} // namespace

PowerFlowProblem make_problem(Network const& n, SwitchState const& state, PowerFlowOptions const& options) {
    PowerFlowProblem problem;
    problem.nodes.resize(n.buses.size());
    problem.branches = two_ports(n, state);
    double const base = n.power_kva;
    NameIndex const buses{n.buses};
    auto const bus_of = [&](Ref const& bus) { return buses[bus.name]; };
    auto const hold = [&](std::size_t node, NodeKind kind, double v) {
        PowerFlowProblem::Node& at = problem.nodes[node];
        if (at.kind == NodeKind::pq || (at.kind == NodeKind::pv && kind == NodeKind::slack)) {
            at.kind = kind;
            at.v = v;
        }
    };
    for (Source const& s : n.sources) {
        std::size_t node = bus_of(s.bus);
        if (s.r_ohm != 0 || s.l_mh != 0) {
            double const omega = 2 * std::numbers::pi * n.frequency_hz;
            Complex const y = base_impedance(n, n.buses[node]) / Complex{s.r_ohm, omega * s.l_mh * 1e-3};
            TwoPort impedance;
            impedance.from = problem.nodes.size();
            impedance.to = node;
            impedance.ff = impedance.tt = y;
            impedance.ft = impedance.tf = -y;
            problem.branches.push_back(impedance);
            node = problem.nodes.size();
            problem.nodes.emplace_back();
        }
        hold(node, NodeKind::slack, s.voltage_pu);
        problem.nodes[node].angle = s.angle_deg * kDegree;
        problem.source_node.push_back(node);
    }
    for (Generator const& g : n.generators) {
        PowerFlowProblem::Node& node = problem.nodes[bus_of(g.bus)];
        if (g.role == GeneratorRole::slack) {
            hold(bus_of(g.bus), NodeKind::slack, g.voltage_setpoint_pu);
            node.angle = g.angle_deg * kDegree;
        } else {
            node.p += g.p_kw / base;
        }
        if (g.role == GeneratorRole::pv) {
            bool const first = node.kind == NodeKind::pq;
            hold(bus_of(g.bus), NodeKind::pv, g.voltage_setpoint_pu);
            node.q_min = (first ? 0 : node.q_min) + g.q_min_kvar.value_or(-1e30) / base;
            node.q_max = (first ? 0 : node.q_max) + g.q_max_kvar.value_or(1e30) / base;
        } else if (g.role == GeneratorRole::pq) {
            node.q += g.q_kvar / base;
        }
    }
    for (Machine const& m : n.machines) {
        problem.nodes[bus_of(m.bus)].p += m.p_kw / base;
        hold(bus_of(m.bus), NodeKind::pv, m.voltage_setpoint_pu);
    }
    problem.shunts.assign(problem.nodes.size(), Complex{});
    Filler filler{n, options, problem};
    for (OnePort const* e : one_ports(n)) {
        if (e->closed_at_start()) {
            e->power_flow(filler);
        }
    }
    hold_angles(n, problem);
    start_angles(problem);
    given_start(n, problem);
    return problem;
}

} // namespace gridspace::sim
