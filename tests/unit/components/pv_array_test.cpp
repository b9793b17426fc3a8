// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/pv/pv_array.hpp"

#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

/// An array of KC200GT modules, with the parameters and the curve of Villalva, Gazoli and Filho, IEEE Trans. Power
/// Electronics 24(5), 2009, table II: ideality 1.3 for 54 cells at 25 degrees.
namespace gridspace::sim {
namespace {

constexpr double kThermalV = 1.380649e-23 * 298.15 / 1.602176634e-19;
constexpr double kIdeality = 1.3 * 54 * kThermalV;
TimeBase const kBase{Rational{1, 20000}};

PvArray kc200gt() {
    PvArray array;
    array.il_a = 8.214;
    array.i0_a = 9.825e-8;
    array.rs_ohm = 0.221;
    array.rsh_ohm = 415.405;
    array.a_v = kIdeality;
    array.alpha_a_k = 3.18e-3;
    return array;
}
double ambient_of(double cell_c, double sun) {
    return cell_c - sun * 25 / 0.8;
}

TEST(PvArray, HasTheMaximumPowerPointOfItsDataSheet) {
    PvArray const array = kc200gt();
    auto const module = array.module_at(1, ambient_of(25, 1));
    double const best = module.best();
    EXPECT_NEAR(module.power_w(best), 200.143, 0.05);
    EXPECT_NEAR(module.voltage_v(best), 26.3, 0.1);
    EXPECT_NEAR(module.current_a(best), 7.61, 0.03);
    EXPECT_NEAR(module.current_a(module.rs * 8.21), 8.21, 0.005); // short circuit
}

/// The same maximum by looking at all voltages.
double highest(PvArray::Module const& module) {
    double most = 0;
    for (double v = 0; v < 45; v += 1e-3) {
        double const i = module.il - module.i0 * (std::exp(v / module.a) - 1) - v / module.rsh;
        most = std::max(most, (v - module.rs * i) * i);
    }
    return most;
}

TEST(PvArray, IsAtItsMaximumForEverySunAndTemperature) {
    PvArray const array = kc200gt();
    for (double sun : {0.05, 0.3, 0.8, 1.2}) {
        for (double ambient : {-20.0, 10.0, 45.0}) {
            auto const module = array.module_at(sun, ambient);
            EXPECT_NEAR(module.power_w(module.best()), highest(module), 1e-5) << sun << " " << ambient;
        }
    }
    EXPECT_EQ(array.module_at(0, 20).power_w(array.module_at(0, 20).best()), 0);
    // Where IL = I0 exp(u / a): u' = u / T + a (IL' / IL - I0' / I0), with I0 by its cube of T and its band gap.
    auto const open = [&](double cell) {
        auto const m = array.module_at(1, ambient_of(cell, 1));
        double low = 0, high = 45;
        for (int i = 0; i < 60; ++i) {
            double const middle = (low + high) / 2;
            (m.current_a(middle) > 0 ? low : high) = middle;
        }
        return low;
    };
    EXPECT_NEAR(open(25), 32.9, 0.1);
    constexpr double kT = 298.15, kBoltzmann = 8.617333262e-5, kGap = 1.121, kGapSlope = -0.0002677 * 1.121;
    double const of_i0 = 3 / kT + kGap / (kBoltzmann * kT * kT) - kGapSlope / (kBoltzmann * kT);
    double const slope = open(25) / kT + array.a_v * (array.alpha_a_k / array.il_a - of_i0);
    EXPECT_NEAR((open(26) - open(24)) / 2, slope, 0.005 * std::abs(slope));
}

Network array_network(std::string const& keys) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 100}\n"
        "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
        "profiles: {Sun: {hours: [0, 0.0001388888888888889, 0.00013916666666666667], values: [1, 1, 0.4]}}\n"
        "pv: {R: {bus: A, scale: Sun, array: {series: 20, strings: 5, il_a: 8.214, i0_a: 9.825e-8, rs_ohm: 0.221, "
        "rsh_ohm: 415.405, a_v: " +
        fmt::format("{:.12g}", kIdeality) + ", alpha_a_k: 0.00318, efficiency: 0.97" + keys + "}}\n";
    Network n;
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

class PvArrayIn : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Solver, PvArrayIn, testing::Values("phasor", "emt"));

TEST_P(PvArrayIn, GivesItsMaximumBeforeAndAfterACloud) {
    auto const sut = make(GetParam(), array_network("}, ambient_c: 20"), kBase);
    must(sut->initialise());
    PvArray const array = kc200gt();
    double const before = 100 * highest(array.module_at(1, 20)) * 0.97 / 1e3;
    double const after = 100 * highest(array.module_at(0.4, 20)) * 0.97 / 1e3;
    EXPECT_NEAR(read(*sut, "pv.R.p_kw"), before, 2e-4 * before);
    must(sut->advance(SimTime{} + SimSpan{20000}));
    EXPECT_NEAR(read(*sut, "pv.R.p_kw"), after, 2e-4 * before);
    EXPECT_NEAR(read(*sut, "pv.R.available_kw"), after, 1e-6 * before);
    EXPECT_NEAR(read(*sut, "pv.R.dc_voltage_v") * read(*sut, "pv.R.dc_current_a") * 0.97e-3, after, 2e-4 * before);
    EXPECT_NEAR(read(*sut, "pv.R.cell_c"), 20 + 0.4 * 25 / 0.8, 1e-9);
}

TEST_P(PvArrayIn, WithASlowTrackerLosesPowerUntilItHasFoundTheNewMaximum) {
    auto const sut = make(GetParam(), array_network(", mppt_s: 0.4}, ambient_c: 20"), kBase);
    must(sut->initialise());
    PvArray const array = kc200gt();
    auto const bright = array.module_at(1, 20), dull = array.module_at(0.4, 20);
    double worst = 0, lost = 0;
    for (int k = 1; k <= 30; ++k) {
        must(sut->advance(SimTime{} + SimSpan{10040 + 1000 * k})); // the cloud comes from 0.5 to 0.501 s
        double const t = 0.0015 + 0.05 * k;                        // since the middle of its edge
        double const v = dull.best() + (bright.best() - dull.best()) * std::exp(-t / 0.4);
        double const i = dull.il - dull.i0 * std::expm1(v / dull.a) - v / dull.rsh;
        double const kw = std::max(0.0, 100 * (v - dull.rs * i) * i * 0.97e-3);
        worst = std::max(worst, std::abs(read(*sut, "pv.R.p_kw") - kw));
        lost = std::max(lost, read(*sut, "pv.R.available_kw") - read(*sut, "pv.R.p_kw"));
    }
    EXPECT_LT(worst, 0.02);
    EXPECT_GT(lost, 0.01);
}

TEST_P(PvArrayIn, OfWhichLessIsAskedWorksAboveTheVoltageOfItsMaximum) {
    auto const sut = make(GetParam(), array_network("}, ambient_c: 20"), kBase);
    must(sut->initialise());
    double const best = read(*sut, "pv.R.dc_voltage_v");
    must(sut->apply(SetParameter{"pv.R.p_limit_kw", 5}));
    must(sut->advance(SimTime{} + SimSpan{4000}));
    EXPECT_NEAR(read(*sut, "pv.R.p_kw"), 5, 2e-2); // waveforms: the filter
    double const v = read(*sut, "pv.R.dc_voltage_v");
    EXPECT_GT(v, best + 20);
    EXPECT_NEAR(v * read(*sut, "pv.R.dc_current_a") * 0.97e-3, 5, 2e-2);
}

TEST(PvArray, ThatCannotBeIsRefusedWithWhatToDo) {
    struct Case {
        std::string keys, message;
    };
    for (Case const& c : {Case{"p_kw: 3, array: {il_a: 8, i0_a: 1e-7, rs_ohm: 0.2, rsh_ohm: 400, a_v: 1.8}",
                               "has an array, whose cells say its power"},
                          Case{"power_factor: 1", "neither a power at full sun nor cells"},
                          Case{"p_kw: 3, ambient_c: 20", "nothing depends on the temperature"},
                          Case{"array: {il_a: 8, i0_a: 0, rs_ohm: 0.2, rsh_ohm: 400, a_v: 1.8}", "i0_a"}}) {
        Network n;
        auto const diagnostics = read_text("gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 100}\n"
                                           "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A}}\npv: {R: {bus: A, " +
                                               c.keys + "}}\n",
                                           n);
        EXPECT_GE(diagnostics.errors(), 1) << c.keys;
        EXPECT_NE(diagnostics.render().find(c.message), std::string::npos) << diagnostics.render();
    }
}

} // namespace
} // namespace gridspace::sim
