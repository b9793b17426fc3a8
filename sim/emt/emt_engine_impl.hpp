// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/emt/emt_engine.hpp"
#include "sim/emt/grid_following.hpp"
#include "sim/emt/network_circuit.hpp"
#include "sim/emt/pll.hpp"
#include "sim/emt/solver.hpp"

#include <functional>
#include <map>

namespace gridspace::sim::emt {

/// What a CT's secondary shows, as primary amperes: polarity, ratio error, quantum.
struct CtReading {
    std::size_t switch_index{0};
    double factor{1};    ///< sign and ratio error
    double quantum_a{0}; ///< 0: not quantised
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

  private:
    [[nodiscard]] Result<void> act(SetChargingCurrent const& a);
    [[nodiscard]] Result<void> act(SwitchBreaker const& a);
    [[nodiscard]] Result<void> act(ApplyFault const& a);
    [[nodiscard]] Result<void> act(ClearFault const& a);
    [[nodiscard]] Result<void> act(SetParameter const& a);
    [[nodiscard]] Result<void> act(Disconnect const& a);
    [[nodiscard]] Result<int> fault_place(ApplyFault const& a);
    [[nodiscard]] Result<void> set_load(std::size_t load, std::string const& parameter, SetParameter const& a);
    [[nodiscard]] Result<void> step(double t_end, double h);
    void start_plls();
    [[nodiscard]] double scale(Ref const& profile, double t) const;
    /// Power that a follower is to put into the network (W, var) at voltage v (p.u.); `lagged` is its state.
    [[nodiscard]] std::complex<double> wanted(std::size_t follower, double t, double v, std::complex<double>& lagged,
                                              double h) const;
    [[nodiscard]] std::vector<std::complex<double>> start_followers(std::vector<std::complex<double>> const& bus_v);

    void signal(std::string name, std::string unit, std::function<double()> read);
    void phases(std::string const& prefix, std::string const& unit, std::function<double(int)> read);
    void define_signals();
    void bus_signals();
    void branch_signals();
    void unit_signals();

    [[nodiscard]] Space bus_voltage(std::size_t bus) const;
    [[nodiscard]] Space switch_space(std::size_t index) const;
    [[nodiscard]] double ct_current(CtReading const& ct, int phase) const;
    /// Instantaneous powers in kW and kvar of currents flowing from a bus into a switch.
    [[nodiscard]] std::complex<double> switch_power(std::size_t bus, std::size_t index) const;

    Network network_;
    NetworkCircuit parts_;
    EmtOptions options_;
    Solver solver_;
    SimTime now_;
    std::vector<Pll> plls_; ///< by bus
    std::vector<GridFollowing> followers_;
    std::vector<std::complex<double>> demand_; ///< by follower: what it follows, with the lag of its load
    std::map<std::string, std::size_t> faults_;
    std::vector<SignalDef> signals_;
    std::vector<std::function<double()>> readers_;
};

} // namespace gridspace::sim::emt
