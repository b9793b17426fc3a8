// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/components/induction_machine/induction_machine.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <string>

/// Rotor, shaft and steady state of an induction machine. Both engines use these equations; they differ in how they
/// treat the stator. p.u. on the machine's rating, currents into the machine, voltages and fluxes as space vectors in a
/// frame that turns at nominal frequency, speed 1 where the rotor turns with it. [Krause, Wasynczuk and Sudhoff,
/// Analysis of Electric Machinery, 2nd ed. 2002, chapter 4; two cages: Kundur 1994, section 7.2]
///
///   psi = x'' i + psi''                    flux of the stator, psi'' = xm'' sum(psi_k / x_k)
///   psi_k' = w0 (-r_k i_k - j s psi_k)     of each cage, i_k = (psi_k - psi_m) / x_k, psi_m = xm'' i + psi''
///   2 H w' = Im(conj(psi'') i) - load(w)
/// with 1 / xm'' = 1 / xm + sum(1 / x_k) and x'' = xs + xm''.
namespace gridspace::sim::induction {

constexpr std::size_t kCages = 2;
enum StateIndex : std::size_t { kSpeed, kFlux, kStates = kFlux + 2 * kCages };
/// Speed, then real and imaginary part of the flux of each cage.
using State = std::array<double, kStates>;

/// Where it comes to rest at a voltage.
struct Operation {
    double slip{0};
    bool carries{true}; ///< else no slip carries the load, and this is the one of its largest torque beyond the load's
};

class Machine {
  public:
    explicit Machine(InductionMachine const& data);

    [[nodiscard]] std::string const& name() const { return name_; }
    [[nodiscard]] double rating_kva() const { return rating_kva_; }
    [[nodiscard]] double resistance() const { return rs_; }
    /// x''
    [[nodiscard]] double subtransient_reactance() const { return xs_ + xm2_; }
    /// States that are in use: the rest stays 0.
    [[nodiscard]] std::size_t states() const { return kFlux + 2 * cages_; }
    [[nodiscard]] bool running_at_start() const { return running_; }
    void set_load_kw(double kw) { load_ = kw / rating_kva_; }

    /// Flux per current of the stator at a slip; at slip 0 that of the magnetising reactance.
    [[nodiscard]] Complex inductance(double slip) const;
    /// At its terminals in the steady state. `speed`: what a discrete-time stator makes of nominal frequency, p.u.
    [[nodiscard]] Complex impedance(double slip, double speed = 1) const {
        return rs_ + Complex{0, speed} * inductance(slip);
    }
    /// Air-gap torque in the steady state at voltage v.
    [[nodiscard]] double torque(double slip, double v, double speed = 1) const;
    /// Torque of the load. What it drives opposes the motion; below 1 % of nominal speed it ends smoothly.
    [[nodiscard]] double load(double w) const;
    /// The stable operation nearest to synchronous speed.
    [[nodiscard]] Operation operation(double v, double speed = 1) const;

    /// The steady state at voltage v, or standing still without flux where it is stopped or there is no voltage.
    [[nodiscard]] State steady_state(Complex v, double speed = 1) const;
    /// psi''
    [[nodiscard]] Complex flux(State const& x) const;
    [[nodiscard]] double torque(State const& x, Complex i) const { return (std::conj(flux(x)) * i).imag(); }
    void derivative(State const& x, Complex i, double w0, State& dx) const;
    /// Whether it can start at this voltage; the error names it.
    [[nodiscard]] Result<void> check_start(double v) const;

  private:
    [[nodiscard]] Complex cage_flux(State const& x, std::size_t k) const {
        return {x[kFlux + 2 * k], x[kFlux + 2 * k + 1]};
    }
    [[nodiscard]] double surplus(double slip, double v, double speed) const {
        return torque(slip, v, speed) - load(1 - slip);
    }
    std::string name_;
    double rating_kva_, load_, exponent_, h_, rs_, xs_, xm_, xm2_{0};
    std::array<RotorCage, kCages> cage_{};
    std::size_t cages_{1};
    bool running_;
};

/// Signals other than powers and currents, without the name of the element, and their values.
[[nodiscard]] std::vector<SignalDef> signals();
[[nodiscard]] double signal(std::size_t index, Machine const& machine, State const& x, Complex i);

} // namespace gridspace::sim::induction
