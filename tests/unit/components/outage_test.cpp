// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>

/// Everything behind a converter, on a feeder that loses the grid and gets it back.
namespace gridspace::sim {
namespace {

TimeBase const kBase{Rational{1, 6000}};

Network feeder() {
    Network n;
    auto const diagnostics = read_text(
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 100}\n"
        "buses: {G: {voltage_v: 400}, A: {voltage_v: 400}, B: {voltage_v: 400}}\n"
        "sources: {S: {bus: G, r_ohm: 0.01, l_mh: 0.1}}\n"
        "lines: {L: {from: G, to: A, r_ohm: 0.02, l_mh: 0.1}, M: {from: A, to: B, r_ohm: 0.02, l_mh: 0.1}}\n"
        "breaker_types: {b: {mechanism_ms: 20}}\nbreakers: {CB: {line: L, end: from, type: b}}\n"
        "loads: {D: {bus: B, p_kw: 20, power_factor: 0.95, model: constant_power}, E: {bus: A, p_kw: 5, model: "
        "constant_impedance}}\n"
        "pv: {P: {bus: A, p_kw: 10, rating_kva: 12}, R: {bus: B, p_kw: 6, rating_kva: 8, ride_through: {category: II, "
        "enter_service: {delay_s: 1, ramp_s: 2}}}}\n"
        "batteries: {K: {bus: B, capacity_kwh: 20, rating_kva: 15, p_kw: 5}}\n"
        "supercapacitors: {U: {bus: B, capacitance_f: 5, rated_voltage_v: 700, v_min_v: 300, v_start_v: 600, "
        "rating_kva: "
        "10, p_kw: 0.5}}\n"
        "wind_turbines: {W: {bus: A, rated_kw: 10, wind_m_s: 10}}\n"
        "electrolysers: {Y: {bus: A, rated_kw: 8, p_kw: 5}}\n"
        "evs: {V: {bus: B, capacity_kwh: 24, battery_v: 360, max_current_a: 15, soc_start_percent: 20, current_lag_s: "
        "0.02}}\n",
        n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

class LongOutage : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Seconds, LongOutage, testing::Values(0.1, 1, 10, 60));

TEST_P(LongOutage, LeavesNoConverterLost) {
    auto const sut = make("emt", feeder(), kBase);
    must(sut->initialise());
    must(sut->apply(SetParameter{"evs.V.current_a", 15}));
    must(sut->advance(SimTime{} + SimSpan{900}));
    std::map<std::string, double> before;
    for (char const* name : {"pv.P", "pv.R", "battery.K", "supercapacitor.U", "electrolyser.Y", "ev.V", "load.D"}) {
        before[name] = read(*sut, fmt::format("{}.p_kw", name));
    }
    auto const until = [](double t_s) { return SimTime{} + SimSpan{std::llround(t_s * 6000)}; };
    double const back = 0.2 + GetParam();
    must(sut->advance(until(0.2)));
    must(sut->apply(SwitchBreaker{"CB", false}));
    must(sut->advance(until(back)));
    if (GetParam() >= 1) { // what feeds has ceased; a load draws nothing from a dead bus
        for (char const* name : {"pv.P", "pv.R", "battery.K", "wind_turbine.W", "electrolyser.Y", "ev.V"}) {
            EXPECT_NEAR(read(*sut, fmt::format("{}.p_kw", name)), 0, 0.1) << name;
        }
    }
    must(sut->apply(SwitchBreaker{"CB", true}));
    must(sut->advance(until(back + 8)));
    for (auto const& [name, kw] : before) {
        EXPECT_NEAR(read(*sut, name + ".p_kw"), kw, 0.01 * std::abs(kw)) << name;
    }
    EXPECT_GT(read(*sut, "wind_turbine.W.p_kw"), 3); // its blades come back into the wind
    EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 0.994, 5e-3);
}

} // namespace
} // namespace gridspace::sim
