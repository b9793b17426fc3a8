// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Quantities that are set while waveforms are simulated.
#include "tests/unit/emt/emt_fixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

TimeBase const kSettingsBase{Rational{1, 48000}};
constexpr double kOmega = 2 * std::numbers::pi * 60, kLineV = 480;

std::unique_ptr<Engine> stiff_load(std::string const& powers) {
    return started(network_of("buses: {A: {voltage_v: 480}}\ngenerators: {G: {bus: A, role: slack}}\n"
                              "loads: {D: {bus: A, model: constant_impedance, " +
                              powers + "}}\n"),
                   kSettingsBase, Rational{1, 48000});
}

/// How far the currents are from the steady state of these powers behind a stiff source, A; over two periods from `k`
/// steps on.
double away_from_steady_state(Engine& engine, int k, double p_kw, double q_kvar) {
    std::array<std::string, 3> const phases{"a", "b", "c"};
    double const peak_v = kLineV * std::sqrt(2.0 / 3), scale = 1e3 / (kLineV * kLineV);
    double most = 0;
    for (int const end = k + 1600; k < end; ++k) {
        advance(engine, SimTime{k + 1});
        for (std::size_t phase = 0; phase < 3; ++phase) {
            double const angle = kOmega * (k + 1) / 48000 - static_cast<double>(phase) * 2 * std::numbers::pi / 3;
            double const expected = peak_v * scale * (p_kw * std::cos(angle) + q_kvar * std::sin(angle));
            most = std::max(most, std::abs(read(engine, "load.D.i." + phases[phase]) - expected));
        }
    }
    return most;
}

TEST(EmtSettings, AnotherReactivePowerOfALoadLeavesNoDirectCurrent) {
    double const usual_a = 30e3 / kLineV * std::sqrt(2.0 / 3);
    for (int const at : {0, 67, 201, 530}) { // wherever in the period it happens
        for (double const q_kvar : {0.0, 5.0, 60.0}) {
            auto const sut = stiff_load("p_kw: 20, q_kvar: 30");
            advance(*sut, SimTime{at});
            apply(*sut, SetParameter{"loads.D.q_kvar", q_kvar});
            EXPECT_LT(away_from_steady_state(*sut, at, 20, q_kvar), 0.002 * usual_a) << at << ": " << q_kvar;
        }
    }
}

TEST(EmtSettings, ALoadThatIsSetToNothingDrawsNothing) {
    auto const sut = stiff_load("p_kw: 20, q_kvar: 30");
    advance(*sut, SimTime{201});
    apply(*sut, SetParameter{"loads.D.demand_pu", 0});
    EXPECT_LT(away_from_steady_state(*sut, 201, 0, 0), 0.05);
    apply(*sut, SetParameter{"loads.D.demand_pu", 1});
    EXPECT_LT(away_from_steady_state(*sut, 1801, 20, 30), 0.1);
}

TEST(EmtSettings, ALoadThatGetsReactivePowerBeginsInItsSteadyState) {
    for (double const q_kvar : {30.0, -30.0}) { // an inductor or a capacitor that was not there
        auto const sut = stiff_load("p_kw: 20, q_kvar: 0");
        advance(*sut, SimTime{201});
        apply(*sut, SetParameter{"loads.D.q_kvar", q_kvar});
        advance(*sut, SimTime{205}); // the steps that damp what a capacitor rings with
        EXPECT_LT(away_from_steady_state(*sut, 205, 20, q_kvar), 0.1) << q_kvar;
    }
}

} // namespace
} // namespace gridspace::sim::emt
