// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/circuit_face.hpp"
#include "sim/components/faces/phasor_injection.hpp"
#include "sim/components/faces/power_flow_face.hpp"

#include <memory>

namespace gridspace::sim {

enum class Sequence { negative, zero };

/// An element at one bus: its data as in the network file, and a face for everybody who must know what it is. Solvers
/// know these faces and no kinds (docs/design/elements.md).
struct OnePort : Element {
    Ref bus;

    /// Its phases have loads of their own.
    [[nodiscard]] virtual bool unbalanced() const { return false; }

    /// Conductance and susceptance (a capacitor is positive) of the earthed star that it is, kVA at the nominal voltage
    /// `voltage_v` of its bus.
    [[nodiscard]] virtual Complex admittance_kva(double /*voltage_v*/) const { return {}; }
    /// What it is to earth in the sequence networks of a fault, p.u. on the network's base: that star, if nothing else.
    [[nodiscard]] virtual Complex sequence_pu(Sequence /*sequence*/, Surroundings const& around) const {
        return admittance_kva(around.voltage_v(bus)) / around.base_kva();
    }
    /// Whether it connects its bus to earth.
    [[nodiscard]] virtual bool earthed(Surroundings const& /*around*/) const { return admittance_kva(1) != Complex{}; }
    /// Whether its poles are closed at the start.
    [[nodiscard]] virtual bool closed_at_start() const { return true; }

    virtual void power_flow(PowerFlowFace& face) const = 0;
    /// Nothing where the power flow says all: an admittance, or a voltage that is held.
    [[nodiscard]] virtual std::unique_ptr<PhasorInjection> phasor(Surroundings const& /*around*/) const { return {}; }
    virtual void circuit(CircuitFace& face) const = 0;
};

/// What an element is to the voltage of its bus, of what it says to a power flow.
struct Holding {
    bool ideal{false};       ///< holds voltage and angle, and nothing limits its current
    bool regulates{false};   ///< holds its power and the magnitude of the voltage
    bool keeps_alive{false}; ///< its bus has a voltage as long as it is in service
    double rating_kva{0};    ///< of what regulates
};
[[nodiscard]] Holding holding_of(OnePort const& element);

} // namespace gridspace::sim
