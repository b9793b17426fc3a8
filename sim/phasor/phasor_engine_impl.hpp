// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/actions/action_table.hpp"
#include "sim/phasor/faults.hpp"
#include "sim/phasor/fixed_step_solver.hpp"
#include "sim/phasor/network_dae.hpp"
#include "sim/phasor/phasor_engine.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>

/// The inside of the phasor engine. phasor_engine.cpp has its life and the solver, phasor_topology.cpp the network as
/// it is switched, phasor_actions.cpp what may change during a run, phasor_signals.cpp what can be read.
namespace gridspace::sim::phasor {

constexpr double kDegrees = 180 / std::numbers::pi;

class PhasorEngine final : public Engine {
  public:
    PhasorEngine(Network network, PhasorOptions options);
    Result<void> initialise() override;
    Result<void> advance(SimTime until) override;
    Result<void> apply(Action const& action) override {
        return std::visit([this](auto const& a) { return act(a); }, action);
    }
    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t signal) const override { return readers_[signal](); }

  private:
    Result<void> act(SwitchBreaker const& a);
    Result<void> act(SetParameter const& a);
    Result<void> act(Disconnect const& a);
    Result<void> act(Connect const& a);
    Result<void> act(StandBy const& a);
    Result<void> act(SetMode const& a);
    Result<void> act(Repair const& /*a*/) { return {}; }
    Result<void> act(ApplyFault const& a);
    Result<void> act(ClearFault const& a);
    /// Contacts that part now.
    Result<void> open_breakers();
    [[nodiscard]] bool opening(std::size_t breaker) const;

    /// An element at one bus, and what it injects; nothing where an admittance, or a held voltage, says all.
    struct Unit {
        OnePort* element{nullptr};
        std::optional<std::size_t> injection{};
        Holding holding{};
        [[nodiscard]] bool holds_without_injection() const;
    };
    [[nodiscard]] std::size_t bus_of(Ref const& bus) const { return index_of(network_.buses, bus.name); }
    [[nodiscard]] Unit const* unit_named(std::string_view name) const;
    void add_injections();
    /// False when it cannot have this value.
    bool set(Unit const& unit, Quantity const& quantity, double value);
    /// Puts an element into service or takes it out; the same of a unit.
    Result<void> put(std::string const& element, bool into_service);
    Result<void> connect(Unit const& unit, bool connected);

    /// Admittances and bus rules for the switches as they are now; the solver starts anew.
    Result<void> set_topology();
    [[nodiscard]] std::vector<BusRule> bus_rules(std::vector<bool>& fed) const;
    void mark_dead(std::vector<Branch> const& branches, std::vector<bool> fed, std::vector<BusRule>& rules) const;
    /// A generator that holds a voltage meets its reactive limit, or the voltage is back.
    void reach_q_limit(std::size_t bus);
    /// Generators that a jump of the voltages has taken across a reactive limit. False when there are none.
    bool cross_q_limits();

    /// Frequencies of the buses: slopes of their angles behind a lag.
    void follow_angles(double h);
    [[nodiscard]] Result<void> find_state();
    Result<void> restart();
    Result<void> find_slopes();
    [[nodiscard]] Result<void> check_voltages() const;

    void define_signals();
    void define_bus_signals();
    void define_branch_signals();
    void define_held_signals();
    void signal(std::string name, std::string unit, std::function<double()> read) {
        signals_.push_back({std::move(name), std::move(unit)});
        readers_.push_back(std::move(read));
    }

    Network network_;
    PhasorOptions options_;
    SwitchState switches_;
    std::vector<std::unique_ptr<PhasorInjection>> injections_;
    std::vector<Unit> units_; ///< in the order of one_ports(network_)
    Faults faults_;
    std::unique_ptr<NetworkDae> dae_;
    std::unique_ptr<DaeIntegrator> solver_;
    std::multimap<double, std::size_t> pending_; ///< switches that will part, by time
    std::set<std::string> out_;                  ///< disconnected elements
    std::vector<double> angles_, slopes_hz_;     ///< by bus: what follows its angle, rad; and how fast that goes
    std::vector<int> at_q_limit_; ///< by bus: its generators are at their lower (-1) or upper (1) reactive limit
    std::vector<Branch> branches_;
    std::vector<double> y_, yp_;
    double t_{0};
    bool input_changed_{false};
    bool slopes_jump_{false}; ///< voltages turn at another speed from now on
    std::vector<SignalDef> signals_;
    std::vector<std::function<double()>> readers_;
};

} // namespace gridspace::sim::phasor
