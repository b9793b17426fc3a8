// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Instrument transformers against closed forms.
#include "sim/emt/instrument_transformer.hpp"
#include "tests/unit/emt/emt_fixture.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

constexpr double kStep = 1.0 / 48000, kOmega = 2 * std::numbers::pi * 60;

/// 100:1, 2 ohm in all, knee at 40 V r.m.s., 1 uA of magnetising current there.
InstrumentData nearly_ideal_ct() {
    InstrumentData d;
    double const knee = std::numbers::sqrt2 * 40 / kOmega;
    d.core = {InstrumentData::Core::Of::current, {knee / (std::numbers::sqrt2 * 1e-6), 1e-3, knee}, 2, 100, 0};
    return d;
}

TEST(InstrumentTransformer, TheFilterHasTheGainAndPhaseOfAButterworthFromTheFirstStepOn) {
    InstrumentData d;
    d.cutoff_hz = 900;
    InstrumentTransformer sut{d};
    std::complex<double> const x = std::polar(100.0, 0.3);
    sut.start({x, x, x}, kOmega, kStep);
    std::complex<double> const s{0, kOmega};
    double const wc = 2 * std::numbers::pi * 900;
    std::complex<double> const h = wc * wc / (s * s + std::numbers::sqrt2 * wc * s + wc * wc);
    for (int n = 1; n < 2000; ++n) {
        double const t = n * kStep;
        double const u = 100 * std::cos(kOmega * t + 0.3);
        sut.step({u, u, u}, kStep);
        ASSERT_NEAR(sut.value(0), (h * x * std::polar(1.0, kOmega * t)).real(), 1e-3) << n;
    }
}

TEST(InstrumentTransformer, TheFilterStopsWhatIsAboveItsCutoff) {
    InstrumentData d;
    d.cutoff_hz = 900;
    InstrumentTransformer sut{d};
    double largest = 0;
    for (int n = 1; n < 20000; ++n) {
        double const u = std::cos(2 * std::numbers::pi * 9000 * n * kStep);
        sut.step({u, u, u}, kStep);
        largest = n > 10000 ? std::max(largest, std::abs(sut.value(0))) : 0;
    }
    EXPECT_LT(largest, 0.011); // -40 dB a decade above
    EXPECT_GT(largest, 0.001);
}

TEST(InstrumentTransformer, ACtLosesItsMagnetisingCurrentAndNoMore) {
    InstrumentData d = nearly_ideal_ct();
    d.core->slopes.l = 5; // 2 ohm and 5 H: 2 / (w 5) of phase error
    InstrumentTransformer sut{d};
    std::complex<double> const x{100, 0};
    sut.start({x, x, x}, kOmega, kStep);
    std::complex<double> const s{0, kOmega};
    std::complex<double> const h = s / (s + 2.0 / 5);
    for (int n = 1; n < 2000; ++n) {
        double const u = 100 * std::cos(kOmega * n * kStep);
        sut.step({u, u, u}, kStep);
        ASSERT_NEAR(sut.value(0), (h * x * std::polar(1.0, kOmega * n * kStep)).real(), 1e-3) << n;
    }
}

/// When the output first falls to half of a fully offset fault current of `peak` amperes.
double saturated_after(double peak, double remanence) {
    InstrumentData d = nearly_ideal_ct();
    d.core->remanence = remanence * d.core->slopes.knee;
    InstrumentTransformer sut{d};
    sut.start({}, kOmega, kStep);
    for (int n = 1; n < 48000; ++n) {
        double const u = peak * (1 - std::cos(kOmega * n * kStep));
        sut.step({u, u, u}, kStep);
        if (u > peak / 4 && sut.value(0) < 0.5 * u) {
            return n * kStep;
        }
    }
    return 1;
}

TEST(InstrumentTransformer, ACtSaturatesWhenTheIntegralOfItsVoltageReachesTheKnee) {
    // flux(t) = R I / n (t - sin(w t) / w) = knee, solved by bisection
    double const knee = nearly_ideal_ct().core->slopes.knee;
    for (double const peak : {1000.0, 2000.0, 4000.0}) {
        for (double const remanence : {0.0, 0.5}) {
            double low = 0, high = 1;
            for (int i = 0; i < 60; ++i) {
                double const t = (low + high) / 2;
                double const flux = 2 * peak / 100 * (t - std::sin(kOmega * t) / kOmega);
                (flux < knee * (1 - remanence) ? low : high) = t;
            }
            // The air-core inductance lets the current fall with 1 mH / 2 ohm: 0.35 ms to a half.
            double const got = saturated_after(peak, remanence);
            EXPECT_GT(got, low - kStep) << peak << ' ' << remanence;
            EXPECT_LT(got, low + 1e-3) << peak << ' ' << remanence;
        }
    }
    EXPECT_EQ(saturated_after(2, 0), 1); // a load current does not
}

TEST(InstrumentTransformer, ASaturatedCtLetsADirectCurrentDieWithItsAirCoreInductance) {
    InstrumentData d = nearly_ideal_ct();
    d.core->remanence = d.core->slopes.knee; // at the knee from the start
    InstrumentTransformer sut{d};
    sut.start({}, kOmega, kStep);
    for (int n = 1; n <= 96; ++n) {
        sut.step({1000, 1000, 1000}, kStep);
        EXPECT_NEAR(sut.value(0), 1000 * std::exp(-2 / 1e-3 * n * kStep), 20) << n; // backward Euler: first order
    }
}

TEST(InstrumentTransformer, AVtPassesNominalVoltageAndCollapsesWhenItsFluxIsBeyondTheKnee) {
    InstrumentData d;
    double const peak = 10000, knee = 1.2 * peak / kOmega;
    d.core = {InstrumentData::Core::Of::voltage, {knee / 1e-3, 0.1, knee}, 1000, 1, 0};
    for (double const size : {1.0, 1.6}) {
        InstrumentTransformer sut{d};
        sut.start({std::complex<double>{0, -peak}, 0, 0}, kOmega, kStep);
        double worst = 0;
        for (int n = 1; n < 4800; ++n) {
            double const u = size * peak * std::sin(kOmega * n * kStep);
            sut.step({u, 0, 0}, kStep);
            worst = std::max(worst, std::abs(sut.value(0) - u));
        }
        if (size == 1.0) {
            EXPECT_LT(worst, 0.001 * peak);
        } else {
            EXPECT_GT(worst, 0.5 * peak);
        }
    }
}

TEST(InstrumentTransformer, AQuantumRoundsToWholeMilliamperes) {
    InstrumentData d;
    d.quantum = 1e-3;
    InstrumentTransformer const sut{d};
    EXPECT_DOUBLE_EQ(sut.shown(1.2345678), 1.235);
    EXPECT_DOUBLE_EQ(sut.shown(-0.0004), 0);
}

TEST(EmtInstruments, AFilteredCtAndAVtStartSettledAndShowTheirNetwork) {
    auto const sut = started(
        network_of("buses: {A: {voltage_v: 20000}, B: {voltage_v: 20000}}\n"
                   "sources: {S: {bus: A, r_ohm: 0.1, l_mh: 1}}\nlines: {L: {from: A, to: B, r_ohm: 1, l_mh: 5}}\n"
                   "ct_types: {plain: {}, slow: {filter: butterworth2, cutoff_hz: 600, error_percent: 1}}\n"
                   "cts: {P: {line: L, end: from, type: plain}, Q: {line: L, end: to, type: slow}}\n"
                   "vt_types: {v: {ratio: \"11547:66.4\", quantum_mv: 1000}}\nvts: {V: {bus: B, type: v}}\n"
                   "loads: {D: {bus: B, p_kw: 3000, power_factor: 0.9, model: constant_impedance}}\n"),
        TimeBase{Rational{1, 48000}}, Rational{1, 48000});
    double plain = 0, slow = 0;
    std::array<double, 2> volts{};
    for (int n = 1; n <= 800; ++n) {
        advance(*sut, SimTime{n});
        plain = std::max(plain, std::abs(read(*sut, "ct.P.i.a")));
        slow = std::max(slow, std::abs(read(*sut, "ct.Q.i.a")));
        EXPECT_NEAR(read(*sut, "vt.V.v.b"), read(*sut, "bus.B.v.b"), 0.5);
        EXPECT_EQ(read(*sut, "vt.V.v.b"), std::round(read(*sut, "vt.V.v.b")));
        if (n % 400 == 0) {
            volts[static_cast<std::size_t>(n / 400 - 1)] = read(*sut, "ct.Q.i.a");
        }
    }
    EXPECT_NEAR(volts[0], -volts[1], 1e-6 * plain); // no transient: half a cycle later the opposite
    EXPECT_NEAR(slow, plain * 1.01, 1e-3 * plain);  // 60 Hz passes a 600 Hz filter to 5e-5
}

} // namespace
} // namespace gridspace::sim::emt
