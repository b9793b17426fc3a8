// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

#include <utility>

namespace gridspace::sim {

/// A power and its slope over voltage.
struct VoltagePower {
    double p{0}, q{0};
    double dp_dv{0}, dq_dv{0};
};

/// Below this voltage (p.u.) a power that is drawn becomes a constant impedance that meets its model there: constant
/// power has no solution near a fault.
constexpr double kFloorPu = 0.7;

/// A power that depends on the voltage.
class VoltageDependent {
  public:
    virtual ~VoltageDependent() = default;
    /// Multipliers of the nominal powers at a voltage v (p.u.).
    [[nodiscard]] virtual VoltagePower factor(double v, double floor_pu) const = 0;
    [[nodiscard]] VoltagePower factor(double v) const { return factor(v, kFloorPu); }
    /// What it draws at nominal voltage, kVA: together, and of one phase to earth.
    [[nodiscard]] virtual Complex nominal_kva() const = 0;
    [[nodiscard]] virtual Complex nominal_kva(std::size_t phase) const = 0;
    /// Shares of the active and the reactive power that go with the square of the voltage.
    [[nodiscard]] virtual std::pair<double, double> impedance_shares() const = 0;
};

/// Powers and impedances at one bus, for a PowerFlowFace.
struct IdealSource {
    double voltage_pu{1}, angle_deg{0};
    Complex z1_ohm{}, z0_ohm{}; ///< positive and zero sequence; 0: it holds its bus
};
struct Regulation {
    double p_kw{0}, voltage_pu{1};
    double q_min_kvar{-1e30}, q_max_kvar{1e30};
    double rating_kva{0};    ///< of what has states behind it and can
    bool keeps_alive{false}; ///< hold the angle of an island where nothing else does; the largest one
};

/// What an element can be in a power flow, balanced or by phase. At most one of source() and regulate() of an element.
class PowerFlowFace {
  public:
    virtual ~PowerFlowFace() = default;
    /// Holds voltage and angle.
    virtual void source(Ref const& bus, IdealSource const& source) = 0;
    /// Holds its power and the magnitude of the voltage, as far as its reactive limits let it.
    virtual void regulate(Ref const& bus, Regulation const& regulation) = 0;
    /// Constant power into the network, kVA; by phase: balanced currents that carry it.
    virtual void inject(Ref const& bus, Complex kva) = 0;
    /// Admittance to earth, kVA at nominal voltage: conductance, and susceptance (a capacitor is positive).
    virtual void admit(Ref const& bus, Complex kva) = 0;
    /// A power that is drawn, times `scale`; it must outlive the power flow.
    virtual void draw(Ref const& bus, VoltageDependent const& load, double scale) = 0;
    /// Nominal voltage of a bus, line to line, r.m.s.
    [[nodiscard]] virtual double voltage_v(Ref const& bus) const = 0;
    /// Nominal angular frequency, rad/s.
    [[nodiscard]] virtual double omega() const = 0;
    /// The value of a profile at the time of this power flow; 1 without one.
    [[nodiscard]] virtual double scale(Ref const& profile) const = 0;
};

} // namespace gridspace::sim
