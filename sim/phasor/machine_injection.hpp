// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/components/faces/phasor_injection.hpp"
#include "sim/machines/synchronous_machine.hpp"

namespace gridspace::sim::phasor {

/// Synchronous machine with regulators: the rotor of sim/machines, a stator without transients (flux follows at once,
/// at nominal speed). States: those of the rotor.
class MachineInjection final : public PhasorInjection {
  public:
    MachineInjection(Network const& network, Machine const& machine, std::size_t bus);
    [[nodiscard]] std::size_t states() const override { return machines::kStates; }
    /// Power out of the machine at the start, p.u. on the network's base; before start().
    void set_start_power(Complex s) { start_power_ = s; }
    void start(double t, Complex v, std::span<double> x) override;
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    /// The field voltage reaches a limit, or leaves it.
    [[nodiscard]] bool has_event() const override { return data_.avr.has_value() && !data_.classical; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override;
    void on_event(std::span<double> x) override;
    /// Fails when the field voltage of the start is outside its limits.
    [[nodiscard]] Result<void> check_field(std::span<double const> x) const;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] machines::MachineData const& data() const { return data_; }
    [[nodiscard]] std::string const& name() const { return name_; }

  private:
    struct Stator {
        double id{0}, iq{0};
        Complex i;   ///< out of the machine, own rating
        double v{0}; ///< at the terminals
    };
    [[nodiscard]] Stator stator(machines::State const& x, Complex v) const;

    std::string name_;
    machines::MachineData data_;
    machines::Setpoints set_;
    double w0_, to_network_; ///< own rating over the network's base
    double base_hz_;
    int at_limit_{0}; ///< -1 lower, 1 upper
    Complex start_power_;
    double p_kw_, voltage_setpoint_pu_; ///< as in the network file, or as set since
};

} // namespace gridspace::sim::phasor
