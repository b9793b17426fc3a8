// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What stops at a limit in phasors: batteries, reactive powers of generators, currents of converters; earth
// connections.
#include "common/config/yaml.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::sim::phasor {
namespace {

using testing::HasSubstr;

Network network_of(std::string_view body) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n" + std::string{body};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return network.value_or(Network{});
}

std::unique_ptr<Engine> started(std::string_view body, double fixed_step_s = 0) {
    PhasorOptions options{.time_base = TimeBase{Rational{1, 100}}};
    options.fixed_step_s = fixed_step_s;
    auto engine = make_phasor_engine(network_of(body), options);
    EXPECT_TRUE(engine.has_value());
    auto const ok = (*engine)->initialise();
    EXPECT_TRUE(ok.has_value()) << (ok ? "" : ok.error().message);
    return std::move(*engine);
}

double read(Engine const& engine, std::string const& name) {
    std::size_t const i = engine.find_signal(name);
    EXPECT_LT(i, engine.signals().size()) << name;
    return engine.value(i);
}

void run(Engine& engine, int from, int to) {
    for (int n = from + 1; n <= to; ++n) {
        auto const ok = engine.advance(SimTime{n});
        ASSERT_TRUE(ok.has_value()) << ok.error().message;
    }
}

constexpr std::string_view kBattery =
    "buses: {A: {voltage_v: 400}}\ngenerators: {G: {bus: A, role: slack}}\n"
    "batteries: {X: {bus: A, capacity_kwh: 1, rating_kva: 50, p_kw: 36, efficiency: 0.9, "
    "soc_start_percent: 50, soc_min_percent: 20, soc_max_percent: 60}}\n";

TEST(PhasorBattery, StopsExactlyWhereItIsEmptyAndFull) {
    for (double const fixed_step_s : {0.0, 0.01}) {
        auto const sut = started(kBattery, fixed_step_s);
        run(*sut, 0, 900);
        EXPECT_NEAR(read(*sut, "battery.X.soc_percent"), 50 - 100 * 40 * 9 / 3600.0, 1e-4); // 36 / 0.9 kW for 9 s
        EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 36, 1e-6);
        run(*sut, 900, 3600);
        EXPECT_EQ(read(*sut, "battery.X.soc_percent"), 20);
        EXPECT_EQ(read(*sut, "battery.X.p_kw"), 0);
        EXPECT_TRUE(sut->apply(SetParameter{"batteries.X.p_kw", -40}).has_value());
        run(*sut, 3600, 4600);
        EXPECT_NEAR(read(*sut, "battery.X.soc_percent"), 20 + 100 * 36 * 10 / 3600.0, 1e-4); // 40 * 0.9 kW
        run(*sut, 4600, 9000);
        EXPECT_EQ(read(*sut, "battery.X.soc_percent"), 60);
        EXPECT_EQ(read(*sut, "battery.X.p_kw"), 0);
    }
}

TEST(PhasorGenerator, GivesUpItsVoltageAtItsReactiveLimitAndTakesItUpAgain) {
    for (double const fixed_step_s : {0.0, 0.01}) {
        auto const sut = started(
            "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\ngenerators:\n"
            "  S: {bus: A, role: slack}\n"
            "  G: {bus: B, role: pv, p_kw: 10, voltage_setpoint_pu: 1, q_min_kvar: -5, q_max_kvar: 20}\n"
            "lines: {L: {from: A, to: B, r_ohm: 0.05, x_ohm: 0.1}}\n"
            "loads: {D: {bus: B, p_kw: 10, q_kvar: 10, lag_s: 0.5}, E: {bus: B, p_kw: 30, power_factor: 0.5, model: "
            "constant_impedance}}\n",
            fixed_step_s);
        double const q_start = read(*sut, "generator.G.q_kvar");
        EXPECT_NEAR(q_start, 20, 1e-6); // 10 + 52 less what the line brings: at its limit from the start
        EXPECT_LT(read(*sut, "bus.B.v_pu"), 1);
        EXPECT_TRUE(sut->apply(Disconnect{"E"}).has_value());
        run(*sut, 0, 100);
        EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 1, 1e-6); // regained
        EXPECT_LT(read(*sut, "generator.G.q_kvar"), 20);
        EXPECT_TRUE(sut->apply(SetParameter{"loads.D.p_kw", 200}).has_value());
        run(*sut, 100, 500);
        EXPECT_NEAR(read(*sut, "generator.G.q_kvar"), 20, 1e-4); // and lost again
        EXPECT_LT(read(*sut, "bus.B.v_pu"), 0.99);
    }
}

TEST(PhasorLoad, WithALagIsAnImpedanceInAFaultAndItsDemandStays) {
    for (double const fault_ohm : {0.02, 1e-6}) {
        auto const sut = started(
            "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.05}}\n"
            "lines: {L: {from: A, to: B, r_ohm: 0.05, x_ohm: 0.1}}\n"
            "loads: {D: {bus: B, p_kw: 30, q_kvar: 10, lag_s: 5}, "
            "R: {bus: B, p_kw: 10, lag_s: 5, model: dc_constant_power}}\n");
        EXPECT_TRUE(sut->apply(ApplyFault{"", "B", 0, FaultType::three_phase_ground, fault_ohm, "f"}).has_value());
        run(*sut, 0, 100);
        double const v = read(*sut, "bus.B.v_pu");
        EXPECT_LT(v, 0.4);
        // For 1 s of its lag of 5 s the demand of the one goes to what it is at 0.7 p.u.: the same.
        EXPECT_NEAR(read(*sut, "load.D.p_kw"), 30 * v * v / 0.49, 1e-6);
        EXPECT_NEAR(read(*sut, "load.D.q_kvar"), 10 * v * v / 0.49, 1e-6);
        EXPECT_NEAR(read(*sut, "load.R.p_kw"), 1.2 * 10 * v, 1e-6); // its current is at its limit
        EXPECT_TRUE(sut->apply(ClearFault{"f"}).has_value());
        run(*sut, 100, 110);
        EXPECT_NEAR(read(*sut, "load.D.p_kw"), 30, 1e-6);
        EXPECT_NEAR(read(*sut, "load.R.p_kw"), 10, 1e-6);
    }
}

TEST(PhasorConverters, KeepTheirCurrentWithinTheirLimitInAFault) {
    auto const sut =
        started("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.05}}\n"
                "lines: {L: {from: A, to: B, r_ohm: 0.05, x_ohm: 0.1}}\npv: {P: {bus: B, p_kw: 30}}\n"
                "batteries: {X: {bus: B, capacity_kwh: 1, rating_kva: 20, p_kw: 20}}\n");
    EXPECT_NEAR(read(*sut, "pv.P.p_kw"), 30, 1e-9);
    EXPECT_TRUE(sut->apply(ApplyFault{"", "B", 0, FaultType::three_phase_ground, 0.02, "f"}).has_value());
    run(*sut, 0, 10);
    double const v = read(*sut, "bus.B.v_pu");
    EXPECT_LT(v, 0.4);
    EXPECT_NEAR(read(*sut, "pv.P.p_kw"), 1.2 * 30 * v, 1e-6);
    EXPECT_NEAR(read(*sut, "battery.X.p_kw"), 1.2 * 20 * v, 1e-6);
}

TEST(PhasorNetworks, APartThatNothingConnectsToEarthIsRefusedAsInWaveforms) {
    std::string const grid =
        "buses: {A: {voltage_v: 20000}, B: {voltage_v: 400}}\nsources: {S: {bus: A}}\n"
        "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 4, from_winding: delta, to_winding: delta";
    auto const sut = make_phasor_engine(network_of(grid + "}}\n"), {.time_base = TimeBase{Rational{1, 100}}});
    ASSERT_TRUE(sut.has_value());
    auto const refused = (*sut)->initialise();
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message, HasSubstr("nothing connects bus 'B' to earth"));
    (void)started(grid + "}}\nloads: {D: {bus: B, p_kw: 1}}\n"); // a load is a star with its point on earth
}

TEST(PhasorBuses, HaveTheFrequencyOfTheMachineThatCarriesThem) {
    auto const sut = started("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\n"
                             "machine_types: {m: {model: classical, constants_pu: {xd1: 0.3}, inertia_h_s: 5}}\n"
                             "machines: {M: {bus: A, type: m, rating_kva: 100, p_kw: 50}}\n"
                             "lines: {L: {from: A, to: B, r_ohm: 0.05, x_ohm: 0.1}}\n"
                             "loads: {D: {bus: B, p_kw: 50, model: constant_impedance}, E: {bus: B, p_kw: 10, model: "
                             "constant_impedance}}\n");
    EXPECT_EQ(read(*sut, "bus.B.frequency_hz"), 60);
    EXPECT_TRUE(sut->apply(Disconnect{"E"}).has_value());
    run(*sut, 0, 100);
    double const f = read(*sut, "machine.M.frequency_hz");
    EXPECT_GT(f, 60.3);
    double const slope = (f - 60) / 1.0;
    EXPECT_NEAR(read(*sut, "bus.B.frequency_hz"), f - slope * 0.02, 0.02); // behind a lag of 20 ms
}

} // namespace
} // namespace gridspace::sim::phasor
