// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/dae_solver.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <cmath>

namespace gridspace::sim::phasor {
namespace {

/// Reactive power of a generator without limits, kvar.
constexpr double kUnlimited = 1e30;

} // namespace

std::vector<BusRule> PhasorEngine::bus_rules(std::vector<bool>& fed) const {
    std::vector<BusRule> rules(network_.buses.size());
    for (Source const& s : network_.sources) {
        fed[bus_of(s.bus)] = true;
        if (s.r_ohm == 0 && s.l_mh == 0) {
            rules[bus_of(s.bus)] = {BusRule::Kind::held, std::polar(s.voltage_pu, s.angle_deg / kDegrees), 1, 0};
        }
    }
    for (Machine const& m : network_.machines) {
        fed[bus_of(m.bus)] = fed[bus_of(m.bus)] || !out_.contains(m.name.name);
    }
    for (Generator const& g : network_.generators) {
        BusRule& rule = rules[bus_of(g.bus)];
        if (g.role == GeneratorRole::slack) {
            rule = {BusRule::Kind::held, std::polar(g.voltage_setpoint_pu, g.angle_deg / kDegrees), 1, 0};
            fed[bus_of(g.bus)] = true;
        } else if (g.role == GeneratorRole::pv && rule.kind != BusRule::Kind::held) {
            double const base = network_.power_kva;
            bool const first = rule.kind != BusRule::Kind::regulated;
            rule = {BusRule::Kind::regulated,
                    {},
                    first ? g.voltage_setpoint_pu : rule.v_set,
                    (first ? 0 : rule.p) + g.p_kw / base,
                    (first ? 0 : rule.q_min) + g.q_min_kvar.value_or(-kUnlimited) / base,
                    (first ? 0 : rule.q_max) + g.q_max_kvar.value_or(kUnlimited) / base,
                    0};
        }
    }
    for (std::size_t i = 0; i < rules.size(); ++i) {
        if (rules[i].kind == BusRule::Kind::regulated && at_q_limit_[i] != 0) {
            rules[i].kind = BusRule::Kind::limited;
            rules[i].at_limit = at_q_limit_[i];
        }
    }
    return rules;
}

Result<void> PhasorEngine::set_topology() {
    std::vector<TwoPort> branches = two_ports(network_, switches_);
    std::vector<Complex> shunts(network_.buses.size());
    for (OnePort const* e : one_ports(network_)) {
        if (!units_.contains(e->name.name) && !out_.contains(e->name.name)) { // its admittance says all
            std::size_t const bus = bus_of(e->bus);
            shunts[bus] += e->admittance_kva(network_.buses[bus].voltage_v) / network_.power_kva;
        }
    }
    if (auto ok = faults_.enter(network_, switches_, out_, branches, shunts); !ok) {
        return ok;
    }
    std::vector<bool> fed(network_.buses.size(), false);
    std::vector<BusRule> rules = bus_rules(fed);
    mark_dead(branches, fed, rules);
    dae_->set_network(branches, shunts, rules);
    branches_ = std::move(branches);
    if (options_.fixed_step_s > 0) {
        solver_ = std::make_unique<FixedStepSolver>(*dae_, options_.fixed_step_s);
    } else {
        solver_ =
            std::make_unique<DaeSolver>(*dae_, DaeOptions{options_.relative_tolerance, options_.absolute_tolerance});
    }
    for (std::size_t i = 0; i < rules.size(); ++i) {
        // A bus that comes back to life starts near nominal voltage.
        if (rules[i].kind != BusRule::Kind::dead && std::abs(dae_->voltage(i, y_)) < 0.01) {
            dae_->set_voltage(i, 1, y_);
        }
    }
    input_changed_ = true;
    return {};
}

void PhasorEngine::mark_dead(std::vector<TwoPort> const& branches, std::vector<bool> fed,
                             std::vector<BusRule>& rules) const {
    for (bool changed = true; changed;) {
        changed = false;
        for (TwoPort const& b : branches) {
            if ((b.ft != Complex{} || b.tf != Complex{}) && fed[b.from] != fed[b.to]) {
                fed[b.from] = fed[b.to] = changed = true;
            }
        }
    }
    for (std::size_t i = 0; i < rules.size(); ++i) {
        if (!fed[i]) {
            rules[i] = {BusRule::Kind::dead, {}, 1, 0};
        }
    }
}

void PhasorEngine::reach_q_limit(std::size_t bus) {
    int& at = at_q_limit_[bus];
    BusRule const& rule = dae_->rule(bus);
    double const q = rule.kind == BusRule::Kind::regulated ? dae_->regulating_q(bus, t_, y_) : 0;
    at = at != 0 ? 0 : rule.q_max - q < q - rule.q_min ? 1 : -1;
}

bool PhasorEngine::cross_q_limits() {
    constexpr double kTouching = -1e-9;
    std::vector<double> values(dae_->events());
    dae_->event_values(t_, y_, values);
    bool any = false;
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        if (values[injections_.size() + i] < kTouching) {
            reach_q_limit(i);
            any = true;
        }
    }
    return any;
}

} // namespace gridspace::sim::phasor
