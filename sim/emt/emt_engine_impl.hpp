// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/actions/action_table.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/emt/grid_following.hpp"
#include "sim/emt/instrument_transformer.hpp"
#include "sim/emt/network_circuit.hpp"
#include "sim/emt/phase_following.hpp"
#include "sim/emt/pll.hpp"
#include "sim/emt/solver.hpp"

#include <functional>
#include <map>
#include <optional>
#include <span>

namespace gridspace::sim::emt {

/// Fewer steps in a period of the fundamental do not describe it.
constexpr double kMinStepsPerPeriod = 8;

/// An instrument transformer and what it is connected to.
struct MeteredPlace {
    InstrumentTransformer transformer;
    bool current{true};
    std::size_t at{0}; ///< switch of a CT, first node of a VT
};

/// The waveform solver behind the interface of all engines. signals: emt_signals.cpp; actions: emt_actions.cpp.
class EmtEngine final : public Engine {
  public:
    EmtEngine(Network network, NetworkCircuit parts, EmtOptions options);

    [[nodiscard]] Result<void> initialise() override;
    [[nodiscard]] Result<void> advance(SimTime until) override;
    [[nodiscard]] Result<void> apply(Action const& action) override;
    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t signal) const override { return readers_[signal](); }
    void will_read(std::span<std::size_t const> signals) override;

  private:
    [[nodiscard]] Result<void> act(SwitchBreaker const& a);
    [[nodiscard]] Result<void> act(ApplyFault const& a);
    [[nodiscard]] Result<void> act(ClearFault const& a);
    [[nodiscard]] Result<void> act(SetParameter const& a);
    [[nodiscard]] Result<void> act(Disconnect const& a);
    [[nodiscard]] Result<void> act(Connect const& a);
    [[nodiscard]] Result<void> act(StandBy const& a);
    [[nodiscard]] Result<void> act(SetMode const& a);
    [[nodiscard]] Result<void> act(Repair const& /*a*/) { return {}; }
    [[nodiscard]] Result<int> fault_place(ApplyFault const& a);
    [[nodiscard]] int far_node(TwoPortParts::Section const& section) const;
    [[nodiscard]] Result<int> cut(TwoPortParts& line, std::size_t section, double place, std::string const& name);
    /// The switch that `open:` and `close:` work: of a breaker, or of an element that has one.
    [[nodiscard]] std::optional<std::size_t> switch_named(std::string const& name) const;
    /// False when there is no such element, or it cannot have this value; fails where it refuses it.
    [[nodiscard]] Result<bool> set_one_port(Setting const& setting, double value);
    bool set_in_parts(NetworkCircuit::OnePortParts const& parts, Quantity const& quantity, double value);
    bool set_two_port(Setting const& setting, double value);
    [[nodiscard]] PowerModel* model_of(NetworkCircuit::OnePortParts const& parts) const {
        return parts.injection < 0 ? nullptr : parts_.injections[static_cast<std::size_t>(parts.injection)].model.get();
    }
    /// By its name; the number of them when there is none.
    [[nodiscard]] std::size_t one_port_named(std::string_view name) const;
    void stand_by(NetworkCircuit::OnePortParts const& parts, bool on);
    /// Those behind these switches, which are about to close.
    void resume_converters(std::vector<int> const& switches);
    /// Gives the star of an element at one bus the admittance that the element has now.
    void change_star(std::size_t one_port);
    void change_inductance(NetworkCircuit::OnePortParts& parts, double l_h);
    [[nodiscard]] Result<void> step(double t_end, double h);
    /// Where waveforms begin by the balanced power flow.
    struct BalancedStart {
        std::vector<std::array<std::complex<double>, 3>> bus_v; ///< by bus and phase, p.u.
        std::vector<Solver::NortonStart> norton;
        std::vector<double> kvar; ///< of elements at one bus
    };
    [[nodiscard]] Result<BalancedStart> balanced_start() const;
    // unbalanced_start.cpp
    [[nodiscard]] Result<void> initialise_unbalanced();
    [[nodiscard]] Result<void> initialise_around_norton();
    [[nodiscard]] Result<void> begin(std::vector<Solver::NortonStart> const& norton,
                                     std::vector<std::array<std::complex<double>, 3>> const& injections);
    /// What is to be looked at and set once the solver has its steady state.
    [[nodiscard]] Result<void> finish_start();
    void start_plls();
    /// What a step asks of an injection, side by side.
    struct Following {
        int node{0};
        bool by_phase{false};
        double filter_kvar{0};
        PowerModel* model{nullptr};
        std::complex<double> power; ///< that is wanted, VA
    };
    /// Power that an injection is to put into the network from now on, VA.
    [[nodiscard]] static std::complex<double> wanted(Following const& injection, double t, double v, double h);
    // Currents that follow the voltage do not depend on each other within a step: those of a part of the solver.
    using Injections = std::span<int const>;
    void inject(Injections injections, double h);
    void step_injections(Injections injections, double t_end, double h);
    /// Those of part `part` of `parts`.
    void step_plls(std::size_t part, std::size_t parts, double h);
    /// Voltages by bus and phase, p.u. of nominal; reactive powers of elements at one bus, kvar.
    using BusPhases = std::array<std::complex<double>, 3>;
    [[nodiscard]] std::vector<BusPhases> start_injections(std::vector<BusPhases> const& bus_v,
                                                          std::vector<double> const& kvar);
    void add_instruments();
    void start_instruments();
    [[nodiscard]] std::array<double, 3> instrument_input(MeteredPlace const& i) const;

    void signal(std::string name, std::string unit, std::function<double()> read);
    void phases(std::string const& prefix, std::string const& unit, std::function<double(int)> read);
    void define_signals();
    void bus_signals();
    void two_port_signals();
    void switch_signals();
    void instrument_signals();
    void rotor_signals();
    void position_signal(std::string const& prefix, int breaker);
    void one_port_signals();
    void ideal_source_signals(std::string const& prefix, NetworkCircuit::OnePortParts const& parts);
    /// What everything else at the bus of an ideal source takes: that gives it.
    [[nodiscard]] double rest_of_bus(std::size_t bus, std::size_t own_switch, int phase) const;
    void powers_and_currents(std::string const& prefix, std::size_t bus, int breaker, double sign);

    [[nodiscard]] Space bus_voltage(std::size_t bus) const;
    [[nodiscard]] Space switch_space(std::size_t index) const;
    /// Instantaneous powers in kW and kvar of currents flowing from a bus into a switch.
    [[nodiscard]] std::complex<double> switch_power(std::size_t bus, std::size_t index) const;

    Network network_;
    NetworkCircuit parts_;
    EmtOptions options_;
    Solver solver_;
    SimTime now_;
    std::vector<Pll> plls_;                                        ///< by bus
    std::vector<std::size_t> read_plls_;                           ///< buses whose loop somebody reads
    std::vector<std::pair<std::size_t, std::size_t>> pll_signals_; ///< signal, bus
    std::vector<OnePort*> one_ports_;                              ///< of network_
    std::vector<TwoPort*> two_ports_;                              ///< of network_
    std::vector<GridFollowing> converters_;                        ///< by injection
    std::vector<Following> following_;                             ///< by injection
    std::vector<PhaseFollowing> phase_currents_;                   ///< by injection; used where it is by phase
    std::vector<MeteredPlace> instruments_;                        ///< in the order of the list
    std::map<std::string, std::size_t> faults_;
    std::vector<SignalDef> signals_;
    std::vector<std::function<double()>> readers_;
};

} // namespace gridspace::sim::emt
