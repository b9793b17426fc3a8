// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/circuit_face.hpp"
#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/phasor_injection.hpp"

#include <array>
#include <complex>

/// The control of a grid-forming converter: a virtual synchronous machine with frequency and voltage droop behind the
/// impedance of its filter. Both engines use these equations; they differ in how they treat the filter. p.u. on the
/// converter's rating, speed as deviation from nominal.
///
/// A droop whose measured power passes a first-order filter of time constant T is the same control with
/// 2 H = T / droop. [D'Arco and Suul, Equivalence of virtual synchronous machines and frequency-droops for
/// converter-based microgrids, IEEE Trans. Smart Grid 5(1), 2014; Chandorkar, Divan and Adapa, IEEE Trans. Ind. Appl.
/// 29(1), 1993]
namespace gridspace::sim {

/// Its keys in the network file.
struct GridForming {
    double voltage_setpoint_pu{1};
    double droop_percent{2}, voltage_droop_percent{5}; ///< at rated active and reactive power
    double inertia_h_s{0.5};
    double integral_ki{0}; ///< brings the frequency back; 0: droop only
    double voltage_ki{30}; ///< p.u. of its internal voltage per p.u. of error and second
    double power_filter_s{0.02};
    double r_pu{0.01}, x_pu{0.15};
    double current_limit_pu{1.2};
    double ramp_s{0.5}; ///< of the voltage, after standing by

    void fields(elements::Fields& f);
};

struct Battery;

namespace forming {

enum StateIndex : std::size_t {
    kSpeed,    ///< deviation from nominal
    kAngle,    ///< of the internal voltage, rad, in a frame that turns at nominal frequency
    kEmf,      ///< internal voltage
    kReactive, ///< measured reactive power
    kIntegral, ///< of the speed deviation
    kSoc,      ///< state of charge, percent
    kStates
};
using State = std::array<double, kStates>;

/// What its control holds.
struct Setpoints {
    double p_ref{0}, v_ref{1}, q_ref{0}, w_ref{0};
    bool isochronous{false}; ///< else its integral stays where it is
    double ramp_from{0}, ramp_start_s{-1e9};
};

/// At its terminals.
struct Terminals {
    double p{0}, q{0}, v{0};
    double withheld{0}; ///< part of the internal voltage that the current limit takes back
};

/// One converter with what is set in a run.
class Control {
  public:
    Control(Battery const& battery, double w0);

    GridForming data;
    Setpoints set;
    double rating_kva;

    [[nodiscard]] Complex impedance(double speed = 1) const { return {data.r_pu, speed * data.x_pu}; }
    /// The steady state with terminal voltage v and current i (out of the converter).
    [[nodiscard]] State steady_state(Complex v, Complex i, double speed = 1);
    [[nodiscard]] Result<void> check_start() const;
    void derivative(State const& x, Terminals const& at, double t, State& dx) const;
    /// Share of the drive across the filter that the current limit lets through.
    [[nodiscard]] double share(Complex drive) const;
    /// Begins at the angle and size of the voltage that is there; the voltage comes along a ramp.
    void resume(double t, Complex v, State& x);
    bool change(std::string_view quantity, double value);
    void mode(std::string_view word) { set.isochronous = word == "isochronous"; }
    [[nodiscard]] std::string const& name() const { return name_; }

  private:
    std::string name_;
    double w0_;
    double p_kw_;
    double start_current_{0};
    double capacity_kwh_, efficiency_, soc_start_percent_;
};

/// Their signals other than powers and currents, without the name of the element, and the values.
[[nodiscard]] std::vector<SignalDef> signals();
[[nodiscard]] double signal(std::size_t index, State const& x, double base_hz, double share);

[[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Battery const& battery, Surroundings const& around);
[[nodiscard]] std::shared_ptr<emt::NortonElement> waveform(Battery const& battery, CircuitFace const& face);

} // namespace forming
} // namespace gridspace::sim
