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
void hold_angles(PowerFlowProblem& problem) {
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
    for (Branch const& b : problem.branches) {
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
    // The largest first, the first of equals.
    std::vector<PowerFlowProblem::Unit const*> order;
    for (PowerFlowProblem::Unit const& unit : problem.units) {
        if (unit.holds == PowerFlowProblem::Unit::Holds::power_and_voltage && unit.keeps_alive) {
            order.push_back(&unit);
        }
    }
    std::stable_sort(order.begin(), order.end(),
                     [](auto const* a, auto const* b) { return a->rating_kva > b->rating_kva; });
    for (PowerFlowProblem::Unit const* unit : order) {
        if (!held[top(unit->node)]) {
            problem.nodes[unit->node].kind = NodeKind::slack;
            held[top(unit->node)] = true;
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
    for (Branch const& b : problem.branches) {
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
    using Unit = PowerFlowProblem::Unit;
    Filler(Network const& n, PowerFlowOptions const& options, PowerFlowProblem& problem)
        : n_{n}, options_{options}, problem_{problem}, around_{n} {}

    void take(OnePort const& e) {
        problem_.units.push_back({.node = around_.bus(e.bus)});
        if (e.closed_at_start()) {
            e.power_flow(*this);
        }
    }

    void source(Ref const& bus, IdealSource const& s) override {
        std::size_t const at = around_.bus(bus);
        std::size_t node = at;
        if (s.z1_ohm != Complex{}) {
            Complex const y = around_.base_ohm(bus) / s.z1_ohm;
            node = problem_.nodes.size();
            problem_.branches.push_back({{y, -y, -y, y}, Branch::kNone, node, at});
            problem_.nodes.emplace_back();
        }
        hold(node, NodeKind::slack, s.voltage_pu);
        problem_.nodes[node].angle = s.angle_deg * kDegree;
        unit().holds = Unit::Holds::voltage_and_angle;
        unit().node = node;
    }
    void regulate(Ref const& bus, Regulation const& r) override {
        double const base = n_.power_kva;
        PowerFlowProblem::Node& node = problem_.nodes[around_.bus(bus)];
        node.p += r.p_kw / base;
        bool const first = node.kind == NodeKind::pq;
        hold(around_.bus(bus), NodeKind::pv, r.voltage_pu);
        node.q_min = (first ? 0 : node.q_min) + r.q_min_kvar / base;
        node.q_max = (first ? 0 : node.q_max) + r.q_max_kvar / base;
        unit().holds = Unit::Holds::power_and_voltage;
        unit().kva = r.p_kw;
        unit().rating_kva = r.rating_kva;
        unit().keeps_alive = r.keeps_alive;
    }
    void inject(Ref const& bus, Complex kva) override {
        PowerFlowProblem::Node& node = problem_.nodes[around_.bus(bus)];
        node.p += kva.real() / n_.power_kva;
        node.q += kva.imag() / n_.power_kva;
        unit().kva += kva;
    }
    void admit(Ref const& bus, Complex kva) override {
        problem_.shunts[around_.bus(bus)] += kva / n_.power_kva;
        unit().kva = -std::conj(kva);
        unit().admittance = true;
    }
    void draw(Ref const& bus, VoltageDependent const& load, double scale) override {
        double const k = scale / n_.power_kva;
        Complex const nominal = load.nominal_kva();
        unit().load = problem_.loads.size();
        problem_.loads.push_back({around_.bus(bus), &load, nominal.real() * k, nominal.imag() * k});
    }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return around_.voltage_v(bus); }
    [[nodiscard]] double omega() const override { return around_.omega(); }
    [[nodiscard]] double scale(Ref const& profile) const override {
        return profile_value(n_, profile, options_.hours, options_.start_hour_of_day);
    }

  private:
    Unit& unit() { return problem_.units.back(); }
    void hold(std::size_t node, NodeKind kind, double v) {
        PowerFlowProblem::Node& at = problem_.nodes[node];
        if (at.kind == NodeKind::pq || (at.kind == NodeKind::pv && kind == NodeKind::slack)) {
            at.kind = kind;
            at.v = v;
        }
    }
    Network const& n_;
    PowerFlowOptions const& options_;
    PowerFlowProblem& problem_;
    NetworkAround around_;
};

} // namespace

PowerFlowProblem make_problem(Network const& n, SwitchState const& state, PowerFlowOptions const& options) {
    PowerFlowProblem problem;
    problem.nodes.resize(n.buses.size());
    problem.shunts.resize(n.buses.size());
    problem.branches = branches(n, state);
    Filler filler{n, options, problem};
    for (OnePort const* e : one_ports(n)) {
        filler.take(*e);
    }
    problem.shunts.resize(problem.nodes.size());
    hold_angles(problem);
    start_angles(problem);
    given_start(n, problem);
    return problem;
}

} // namespace gridspace::sim
