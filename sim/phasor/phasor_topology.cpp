// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/dae_solver.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <cmath>

namespace gridspace::sim::phasor {
namespace {

/// Rules of the buses from what their elements say to a power flow.
class RuleMaker final : public PowerFlowFace {
  public:
    RuleMaker(Network const& n, std::vector<BusRule>& rules, std::vector<bool>& fed)
        : around_{n}, rules_{rules}, fed_{fed} {}

    void take(OnePort const& element, bool has_injection, bool in_service) {
        has_injection_ = has_injection;
        in_service_ = in_service;
        element.power_flow(*this);
    }
    void source(Ref const& bus, IdealSource const& s) override {
        std::size_t const i = around_.bus(bus);
        fed_[i] = fed_[i] || in_service_;
        if (!has_injection_) {
            rules_[i] = {BusRule::Kind::held, std::polar(s.voltage_pu, s.angle_deg / kDegrees), 1, 0};
        }
    }
    void regulate(Ref const& bus, Regulation const& r) override {
        std::size_t const i = around_.bus(bus);
        fed_[i] = fed_[i] || (r.keeps_alive && in_service_);
        BusRule& rule = rules_[i];
        if (has_injection_ || rule.kind == BusRule::Kind::held) {
            return;
        }
        double const base = around_.base_kva();
        bool const first = rule.kind != BusRule::Kind::regulated;
        rule = {BusRule::Kind::regulated,
                {},
                first ? r.voltage_pu : rule.v_set,
                (first ? 0 : rule.p) + r.p_kw / base,
                (first ? 0 : rule.q_min) + r.q_min_kvar / base,
                (first ? 0 : rule.q_max) + r.q_max_kvar / base,
                0};
    }
    void inject(Ref const&, Complex) override {}
    void admit(Ref const&, Complex) override {}
    void draw(Ref const&, VoltageDependent const&, double) override {}
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return around_.voltage_v(bus); }
    [[nodiscard]] double omega() const override { return around_.omega(); }
    [[nodiscard]] double scale(Ref const&) const override { return 1; }

  private:
    NetworkAround around_;
    std::vector<BusRule>& rules_;
    std::vector<bool>& fed_;
    bool has_injection_{false}, in_service_{true};
};

} // namespace

std::vector<BusRule> PhasorEngine::bus_rules(std::vector<bool>& fed) const {
    std::vector<BusRule> rules(network_.buses.size());
    RuleMaker maker{network_, rules, fed};
    for (Unit const& unit : units_) {
        bool const gives = !unit.injection || injections_[*unit.injection]->connected();
        maker.take(*unit.element, unit.injection.has_value(), gives && !out_.contains(unit.element->name.name));
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
    std::vector<Branch> branches = sim::branches(network_, switches_);
    std::vector<Complex> shunts(network_.buses.size());
    for (Unit const& unit : units_) {
        if (!unit.injection && !out_.contains(unit.element->name.name)) { // its admittance says all
            std::size_t const bus = bus_of(unit.element->bus);
            shunts[bus] += unit.element->admittance_kva(network_.buses[bus].voltage_v) / network_.power_kva;
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

void PhasorEngine::mark_dead(std::vector<Branch> const& branches, std::vector<bool> fed,
                             std::vector<BusRule>& rules) const {
    for (bool changed = true; changed;) {
        changed = false;
        for (Branch const& b : branches) {
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
