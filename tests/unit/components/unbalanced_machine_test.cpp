// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// What turns and feeds loads that differ from phase to phase, in waveforms.
namespace gridspace::sim {
namespace {

using Phasors = std::array<std::complex<double>, 3>;

TimeBase const kBase{Rational{1, 20000}};
constexpr double kHz = 50, kPeak = 400 * std::numbers::sqrt2 / std::numbers::sqrt3, kStep = 1.0 / 20000;

std::string const kMachineType = "machine_types: {m: {model: full, constants_pu: {xd: 1.3, xq: 1.2, xd1: 0.3, xd2: "
                                 "0.25, xq2: 0.25, xl: 0.18, x0: 0.1, "
                                 "ra: 0.006}, times_s: {td01: 4.5, td02: 0.06, tq02: 0.1}, inertia_h_s: 2, "
                                 "avr: {ka: 50, ta_s: 0.02, tr_s: 0.02, efd_min_pu: 0, efd_max_pu: 4}, governor: "
                                 "{droop_percent: 4, tg_s: 0.05, tt_s: 0.15}}}\n";

Network unbalanced(std::string const& rest) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 50}\n"
        "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\n"
        "lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.1, r0_ohm: 0.1, l0_mh: 0.3}}\n"
        "loads: {D: {bus: B, phase_p_kw: [8, 3, 1], phase_q_kvar: [1, 1, 0.5], model: constant_impedance}}\n" +
        kMachineType + rest;
    Network n;
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

std::string const kMachine = "machines: {G: {bus: A, type: m, rating_kva: 50, p_kw: 12, voltage_setpoint_pu: 1}}\n";

/// Phasors of the three signals with this prefix, over one period of steps from now on.
class Fourier {
  public:
    explicit Fourier(std::string prefix) : prefix_{std::move(prefix)} {}
    void look(Engine const& engine, double t) {
        for (std::size_t k = 0; k < 3; ++k) {
            double const value = read(engine, prefix_ + "." + "abc"[k]);
            sums_[k] += 2 * kStep * kHz * value * std::polar(1.0, -2 * std::numbers::pi * kHz * t);
        }
    }
    /// Positive, negative and zero sequence.
    [[nodiscard]] Phasors sequences() const {
        auto const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
        return {(sums_[0] + turn * sums_[1] + turn * turn * sums_[2]) / 3.0,
                (sums_[0] + turn * turn * sums_[1] + turn * sums_[2]) / 3.0, (sums_[0] + sums_[1] + sums_[2]) / 3.0};
    }

  private:
    std::string prefix_;
    Phasors sums_{};
};

std::pair<Phasors, Phasors> period(Engine& engine, int from_step) {
    Fourier v{"bus.A.v"}, i{"line.L.from.i"};
    for (int k = 1; k <= 400; ++k) {
        must(engine.advance(SimTime{} + SimSpan{from_step + k}));
        double const t = (from_step + k) * kStep;
        v.look(engine, t);
        i.look(engine, t);
    }
    return {v.sequences(), i.sequences()};
}

TEST(UnbalancedMachine, IsAnImpedanceToTheOtherSequencesFromTheFirstPeriodOn) {
    auto const sut = make("emt", unbalanced(kMachine), kBase);
    must(sut->initialise());
    double const ohm = 400.0 * 400 / 50e3;
    for (int const from : {0, 9600}) {
        if (from > 0) {
            must(sut->advance(SimTime{} + SimSpan{from}));
        }
        auto const [v, i] = period(*sut, from);
        EXPECT_NEAR(std::abs(v[0]) / kPeak, 1, 2e-3) << from; // what it regulates
        EXPECT_NEAR(1.5 * (v[0] * std::conj(i[0])).real() / 12e3, 1, 0.02) << from;
        std::complex<double> const z2 = -v[1] / i[1], z0 = -v[2] / i[2];
        EXPECT_NEAR(std::abs(z0 - std::complex<double>{0.006, 0.1} * ohm), 0, 0.02 * ohm * 0.1) << from << " " << z0;
        // The rotor's windings answer at twice the frequency: x2 between x'' and what they let through.
        EXPECT_NEAR(z2.imag() / ohm, 0.25, 0.02) << from;
        EXPECT_GT(std::abs(i[1]), 3) << from;
    }
}

TEST(UnbalancedMachine, BeginsWithoutASwingAndHoldsPowerVoltageAndFrequency) {
    auto const sut = make("emt", unbalanced(kMachine), kBase);
    must(sut->initialise());
    double low = 1e9, high = 0;
    for (int k = 1; k <= 200; ++k) {
        must(sut->advance(SimTime{} + SimSpan{100 * k}));
        low = std::min(low, read(*sut, "machine.G.frequency_hz"));
        high = std::max(high, read(*sut, "machine.G.frequency_hz"));
    }
    EXPECT_GT(low, 49.98);
    EXPECT_LT(high, 50.02);
    EXPECT_GT(high - low, 1e-4); // its torque pulses at twice the frequency
    EXPECT_NEAR(read(*sut, "machine.G.mechanical_kw"), 12, 0.15);
}

TEST(UnbalancedMachine, BesideASourceGivesItsPower) {
    auto const sut =
        make("emt",
             unbalanced("sources: {S: {bus: B, r_ohm: 0.02, l_mh: 0.2, r0_ohm: 0.02, l0_mh: 0.2}}\n"
                        "machines: {G: {bus: A, type: m, rating_kva: 50, p_kw: 7, voltage_setpoint_pu: 1}}\n"),
             kBase);
    must(sut->initialise());
    auto const [v, i] = period(*sut, 0);
    EXPECT_NEAR(std::abs(v[0]) / kPeak, 1, 1e-3);
    EXPECT_NEAR(1.5e-3 * (v[0] * std::conj(i[0])).real(), 7, 0.05);
}

TEST(UnbalancedMachine, GridFormingBatteriesAndInductionMachinesStartThereToo) {
    auto const sut = make(
        "emt",
        unbalanced(
            "batteries: {F: {bus: A, capacity_kwh: 50, rating_kva: 60, p_kw: 14, control: grid_forming}}\n"
            "induction_machines: {M: {bus: B, rating_kva: 3, load_kw: 1.5, inertia_h_s: 0.3, constants_pu: {rs: 0.02, "
            "xs: 0.09, xm: 2.6, rr: 0.03, xr: 0.09}}}\n"),
        kBase);
    must(sut->initialise());
    must(sut->advance(SimTime{} + SimSpan{4000}));
    auto const [v, i] = period(*sut, 4000);
    EXPECT_NEAR(std::abs(v[0]) / kPeak, 1, 5e-3);
    EXPECT_NEAR(read(*sut, "battery.F.frequency_hz"), 50, 0.02);
    std::complex<double> const z2 = -v[1] / i[1];
    double const ohm = 400.0 * 400 / 60e3;
    EXPECT_NEAR(std::abs(z2 / ohm - std::complex<double>{0.01, 0.15}), 0, 0.01) << z2 / ohm;
}

} // namespace
} // namespace gridspace::sim
