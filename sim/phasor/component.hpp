// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"
#include "sim/powerflow/two_port.hpp"

#include <span>
#include <vector>

namespace gridspace::sim::phasor {

/// Something at one bus of the phasor network: states x with x' = f(t, x, v), and the current it injects, g(t, x, v).
/// p.u. on the network's base, phase reference turning at nominal frequency. Functions of their arguments only.
class Component {
  public:
    explicit Component(std::size_t bus) : bus_{bus} {}
    virtual ~Component() = default;

    [[nodiscard]] std::size_t bus() const { return bus_; }
    [[nodiscard]] virtual std::size_t states() const { return 0; }
    /// Initial states in the steady state with bus voltage `v`.
    virtual void start(double /*t*/, Complex /*v*/, std::span<double> /*x*/) {}
    /// Writes x' to `dx` and returns the injected current.
    virtual Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const = 0;

    /// An event function: the solver stops where it crosses zero from above and calls on_event.
    [[nodiscard]] virtual bool has_event() const { return false; }
    [[nodiscard]] virtual double event(double /*t*/, std::span<double const> /*x*/) const { return 1; }
    virtual void on_event(std::span<double> /*x*/) {}

    /// Signals of this component, and their values.
    [[nodiscard]] virtual std::vector<SignalDef> signals() const { return {}; }
    [[nodiscard]] virtual double value(std::size_t signal, double t, std::span<double const> x, Complex v) const = 0;

  private:
    std::size_t bus_;
};

} // namespace gridspace::sim::phasor
