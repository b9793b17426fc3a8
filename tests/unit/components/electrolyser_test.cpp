// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/electrolyser/stack.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// The plant of PHOEBUS (Juelich): 26 kW, 21 cells of 0.25 m2, 750 A, 80 degrees C.
namespace gridspace::sim {
namespace {

using testing::HasSubstr;

constexpr double kRatedKw = 26, kFaradayC = 96485.33212, kRate = kRatedKw / 2; ///< kW / s: ramp_up_s 2

/// Ulleberg's curve in other units than the code's: mA and cm2, and the natural logarithm of LeRoy's temperature.
double cell_voltage(double ma_per_cm2, double celsius, double t1 = -0.1002) {
    double const k = celsius + 273.15;
    double const reversible = 1.5184 - 1.5421e-3 * k + 9.523e-5 * k * std::log(k) + 9.84e-8 * k * k;
    double const ohmic = (8.05e-5 * 1e4 - 2.5e-7 * 1e4 * celsius) * ma_per_cm2 * 1e-3; // ohm cm2
    double const factor = (t1 + 8.424 / celsius + 247.3 / (celsius * celsius)) * 10;   // cm2 / mA
    return reversible + ohmic + 0.185 * std::log10(factor * ma_per_cm2 + 1);
}

/// Hydrogen of 21 cells, kg/s, by Faraday's law; current by bisection.
double hydrogen_kg_per_s(double stack_kw) {
    double low = 0, high = 1e5;
    for (int i = 0; i < 200; ++i) {
        double const middle = (low + high) / 2;
        (21 * middle * cell_voltage(0.1 * middle / 0.25, 80) < 1e3 * stack_kw ? low : high) = middle;
    }
    double const d = 0.1 * low / 0.25;
    return d == 0 ? 0 : d * d / (250 + d * d) * 0.96 * 21 * low / (2 * kFaradayC) * 2.01588e-3;
}

TEST(ElectrolyserStack, HasTheCurveOfUllebergAtEveryTemperatureAndCurrent) {
    Stack sut;
    for (double const celsius : {25.0, 40.0, 60.0, 80.0}) {
        sut.temperature_c = celsius;
        for (double const density : {0.0, 1.0, 50.0, 150.0, 300.0}) {
            EXPECT_NEAR(sut.cell_v(density * 10 * sut.area_m2), cell_voltage(density, celsius), 1e-12)
                << celsius << ' ' << density;
        }
    }
}

TEST(ElectrolyserStack, HasThePublishedReversibleVoltages) { // Ulleberg 2003, section 2
    Stack sut;
    EXPECT_NEAR(sut.reversible_v(), 1.184, 1e-3);
    sut.temperature_c = 25;
    EXPECT_NEAR(sut.reversible_v(), 1.229, 1e-3);
}

TEST(ElectrolyserStack, NeedsTheNameplatePowerOfPhoebusAtItsRatedCurrent) {
    Stack sut;
    auto const kw = [&] { return 1e-3 * 21 * 750 * sut.cell_v(750); };
    EXPECT_NEAR(kw(), kRatedKw, 0.08 * kRatedKw);
    EXPECT_NEAR(kw(), 27.678, 1e-3);
    sut.curve.t1 = 1.002; // negative control: as it is reprinted too
    EXPECT_GT(kw(), 1.2 * kRatedKw);
}

TEST(ElectrolyserStack, TakesTheCurrentThatCarriesItsPower) {
    Stack const sut;
    EXPECT_EQ(sut.current_a(0), 0);
    for (double i = 1e-6; i < 1e5; i *= 3) {
        EXPECT_NEAR(sut.current_a(21 * i * sut.cell_v(i)) / i, 1, 1e-12) << i;
    }
}

TEST(ElectrolyserStack, MakesHydrogenByFaradaysLaw) {
    Stack const sut;
    // 3000 A/m2: 90000 / 90250 0.96 of 21 * 750 A / (2 F) in mol/s.
    EXPECT_NEAR(3600 * sut.hydrogen_g_per_s(750), 567.05, 0.01);
    EXPECT_NEAR(3600 * sut.hydrogen_g_per_s(750) / 2.01588 * 22.414e-3, 6.305, 1e-3); // m3/h at 0 degrees
    EXPECT_EQ(sut.hydrogen_g_per_s(0), 0);
    EXPECT_LT(sut.hydrogen_g_per_s(7.5) / 7.5, 0.05 * sut.hydrogen_g_per_s(750) / 750); // stray currents at 1 %
}

std::string plant_of(std::string const& keys) {
    return "electrolysers: {E: {bus: A, rated_kw: 26, ramp_up_s: 2, ramp_down_s: 1, " + keys + "}}";
}
std::string text_of(std::string const& keys) {
    return AtOneBus::text_with(plant_of(keys));
}
Network network(std::string const& keys, std::string const& more = "") {
    return AtOneBus::network_with(plant_of(keys), more);
}

class Plant : public AtOneBus {
  public:
    Plant(std::string const& solver, std::string const& keys, std::string const& more = "")
        : AtOneBus{solver, network(keys, more)} {}
    double read(std::string const& quantity) const { return sim::read(engine(), "electrolyser.E." + quantity); }
    void ask(double kw) { must(engine().apply(SetParameter{"electrolysers.E.p_kw", kw})); }
};

class ElectrolyserIn : public testing::TestWithParam<char const*> {
  protected:
    [[nodiscard]] bool waveform() const { return std::string{GetParam()} == "emt"; }
    [[nodiscard]] double kw() const { return waveform() ? 0.02 : 1e-7; } ///< tolerance of a power, kW
};
INSTANTIATE_TEST_SUITE_P(Solver, ElectrolyserIn, testing::Values("phasor", "emt", "fixed"));

TEST_P(ElectrolyserIn, StartsSettledAndMakesHydrogen) {
    Plant sut{GetParam(), "p_kw: 20, efficiency: 0.9, power_factor: 0.8"};
    sut.run_to(0.5);
    EXPECT_NEAR(sut.read("p_kw"), 20, kw());
    EXPECT_NEAR(sut.read("q_kvar"), 15, waveform() ? 0.05 : 1e-7);
    EXPECT_NEAR(sut.read("hydrogen_kg") / (0.5 * hydrogen_kg_per_s(18)), 1, 1e-9);
    EXPECT_NEAR(sut.read("specific_kwh_per_kg") * 3600 * hydrogen_kg_per_s(18) / 20, 1, 1e-9);
    EXPECT_NEAR(21e-3 * sut.read("current_a") * sut.read("cell_v"), 0.9 * 20, 1e-9); // energy balance of the stack
    // The higher heating value is 39.4 kWh/kg: no electrolyser needs less.
    EXPECT_GT(sut.read("specific_kwh_per_kg"), 39.4);
}

TEST_P(ElectrolyserIn, RampsToItsNewPowerAndStopsExactlyThere) {
    Plant sut{GetParam(), "p_kw: 10, efficiency: 1"};
    sut.ask(20); // 10 kW at 13 kW/s: 0.76923 s
    for (double const t : {0.25, 0.5, 0.75}) {
        sut.run_to(t);
        EXPECT_NEAR(sut.read("p_kw"), 10 + kRate * t, waveform() ? 0.05 : 1e-6) << t;
    }
    // What it made on the way: Simpson's rule over the ramp.
    double made = 0;
    constexpr int kPieces = 200;
    for (int k = 0; k <= kPieces; ++k) {
        double const weight = k == 0 || k == kPieces ? 1 : k % 2 == 1 ? 4 : 2;
        made += weight * hydrogen_kg_per_s(10 + 10.0 * k / kPieces);
    }
    made *= 10 / kRate / (3 * kPieces);
    sut.run_to(0.77);
    EXPECT_NEAR(sut.read("p_kw"), 20, kw());
    EXPECT_NEAR(sut.read("hydrogen_kg") / (made + (0.77 - 10 / kRate) * hydrogen_kg_per_s(20)), 1,
                waveform() ? 1e-4 : 1e-6);
    sut.ask(13); // 26 kW/s
    sut.run_to(0.87);
    EXPECT_NEAR(sut.read("p_kw"), 20 - 2.6, waveform() ? 0.06 : 1e-6);
    sut.run_to(1.2);
    EXPECT_NEAR(sut.read("p_kw"), 13, kw());
}

TEST_P(ElectrolyserIn, StandsByBelowItsMinimumLoadAndRampsUpFromThere) {
    Plant sut{GetParam(), "p_kw: 6.5, min_load_percent: 25, standby_kw: 0.5"}; // exactly at the minimum
    EXPECT_NEAR(sut.read("p_kw"), 6.5, kw());
    sut.ask(6.4);
    sut.run_to(0.2);
    EXPECT_NEAR(sut.read("p_kw"), 6.5 - 26 * 0.2, waveform() ? 0.06 : 1e-6);
    sut.run_to(0.3); // there since 0.25 s
    EXPECT_NEAR(sut.read("p_kw"), 0.5, kw());
    EXPECT_EQ(sut.read("current_a"), 0);
    EXPECT_EQ(sut.read("specific_kwh_per_kg"), 0);
    EXPECT_NEAR(sut.read("cell_v"), cell_voltage(0, 80), 1e-12);
    double const made = sut.read("hydrogen_kg");
    sut.run_to(0.5);
    EXPECT_NEAR(sut.read("hydrogen_kg"), made, 1e-12);
    sut.ask(13);
    sut.run_to(1);
    EXPECT_NEAR(sut.read("p_kw"), kRate * 0.5, waveform() ? 0.05 : 1e-6);
    sut.run_to(1.6);
    EXPECT_NEAR(sut.read("p_kw"), 13, kw());
    EXPECT_GT(sut.read("hydrogen_kg"), made);
}

TEST_P(ElectrolyserIn, FollowsASlowProfileAndLagsOneThatIsTooFast) {
    // 0.36 s from a half to all of 26 kW: 36 kW/s, which it cannot; then 3.6 s down again, which it can.
    Plant sut{GetParam(), "p_kw: 26, scale: s",
              "profiles: {s: {hours: [0, 0.0001, 0.0002, 0.0012], values: [0.5, 0.5, 1, 0.5]}}\n"};
    sut.run_to(0.36);
    EXPECT_NEAR(sut.read("p_kw"), 13, kw());
    sut.run_to(0.72);
    EXPECT_NEAR(sut.read("p_kw"), 13 + kRate * 0.36, 0.15); // the ramp
    // It meets what is asked, 26 - 3.611 (t - 0.72), where 13 + 13 (t - 0.36) is as much: 1.217 s.
    sut.run_to(1.1);
    EXPECT_NEAR(sut.read("p_kw"), 13 + kRate * 0.74, 0.15);
    for (double const t : {1.3, 2.0, 3.0}) {
        sut.run_to(t);
        EXPECT_NEAR(sut.read("p_kw"), 26 - 13 / 3.6 * (t - 0.72), 0.05) << t; // P: 10 ms behind, 0.036 kW
    }
    sut.run_to(4.5);
    EXPECT_NEAR(sut.read("p_kw"), 13, kw());
}

TEST_P(ElectrolyserIn, StoppedOrTakenOutItRampsFromNothingWhenItIsBack) {
    for (bool const stops : {true, false}) {
        Plant sut{GetParam(), "p_kw: 13"};
        must(stops ? sut.engine().apply(StandBy{"E", true}) : sut.engine().apply(Disconnect{"E"}));
        sut.run_to(0.1);
        EXPECT_NEAR(sut.read("p_kw"), 0, waveform() ? 1e-3 : 1e-12);
        EXPECT_EQ(sut.read("current_a"), 0);
        double const made = sut.read("hydrogen_kg");
        sut.run_to(0.5);
        EXPECT_EQ(sut.read("hydrogen_kg"), made);
        must(stops ? sut.engine().apply(StandBy{"E", false}) : sut.engine().apply(Connect{"E"}));
        sut.run_to(1);
        EXPECT_NEAR(sut.read("p_kw"), kRate * 0.5, waveform() ? 0.05 : 1e-6);
        sut.run_to(1.6);
        EXPECT_NEAR(sut.read("p_kw"), 13, kw());
    }
}

TEST_P(ElectrolyserIn, AtALowVoltageItsCurrentIsLimitedAndItMakesLess) {
    Plant sut{GetParam(), "p_kw: 26, efficiency: 1"};
    sut.run_to(0.2);
    double const before = sut.read("hydrogen_kg");
    must(sut.engine().apply(SetParameter{"sources.S.voltage_pu", 0.6}));
    sut.run_to(0.4); // settled
    double const at = sut.read("hydrogen_kg");
    sut.run_to(0.6);
    double const v = read(sut.engine(), "bus.A.v_pu"), limited = 1.2 * v * 26;
    EXPECT_LT(limited, 19);
    EXPECT_NEAR(sut.read("p_kw"), limited, 0.05);
    EXPECT_NEAR((sut.read("hydrogen_kg") - at) / (0.2 * hydrogen_kg_per_s(limited)), 1, 1e-3);
    EXPECT_NEAR(before / (0.2 * hydrogen_kg_per_s(26)), 1, 1e-6);
}

TEST(Electrolyser, IsAPowerThatIsDrawnInThePowerFlow) {
    Network const n = network("p_kw: 20, power_factor: 0.8");
    auto const flow = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value());
    // v = 1 - z (conj(s / v) + g v) on 100 kVA and 1.6 ohm.
    Complex const z{0.01 / 1.6, 2 * 3.14159265358979 * 50 * 0.05e-3 / 1.6}, s{0.2, 0.15};
    Complex v = 1;
    for (int i = 0; i < 50; ++i) {
        v = 1.0 - z * (std::conj(s / v) + 0.01 * v);
    }
    EXPECT_NEAR(std::abs(flow->buses[0].v), std::abs(v), 1e-9);
}

TEST(Electrolyser, SaysWhatIsWrongWithItsKeys) {
    auto const said = [](std::string const& keys) {
        Network n;
        return read_text(text_of(keys), n).render();
    };
    EXPECT_THAT(said("p_kw: 30"), HasSubstr("'E' is asked for 30 kW, more than its rated_kw of 26"));
    EXPECT_THAT(said("standby_kw: 30"), HasSubstr("draws 30 kW while it stands by"));
    EXPECT_THAT(said("temperature_c: 120"), HasSubstr("does not rise with its current at 120 degrees C"));
    EXPECT_THAT(said("cell: {r2: -2e-6}"), HasSubstr("r1 + r2 T is"));
    EXPECT_THAT(said("cells: 1"), HasSubstr("more heat than hydrogen"));
    EXPECT_THAT(said("cells: 2.5"), HasSubstr("a whole number"));
    EXPECT_THAT(said("min_load_percent: 120"), HasSubstr("min_load_percent is 120, which is out of range"));
    EXPECT_THAT(said("scale: x"), HasSubstr("x"));
}

} // namespace
} // namespace gridspace::sim
