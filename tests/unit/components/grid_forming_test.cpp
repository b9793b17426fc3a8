// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// Grid-forming batteries in both engines against what their equations say.
namespace gridspace::sim {
namespace {

TimeBase const kBase{Rational{1, 24000}};
constexpr double kRatedKva = 150, kRatedA = 150e3 / (std::numbers::sqrt3 * 480);

Network network(std::string const& elements, bool good = true) {
    std::string const text = "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n"
                             "buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                             "lines: {L: {from: A, to: B, r_ohm: 0.01, l_mh: 0.05, r0_ohm: 0.03, l0_mh: 0.1}}\n" +
                             elements;
    Network n;
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors() == 0, good) << diagnostics.render();
    return n;
}

std::string battery(std::string const& name, std::string const& bus, double kva, std::string const& keys) {
    return fmt::format("  {}: {{bus: {}, capacity_kwh: 100, rating_kva: {}, control: grid_forming, {}}}\n", name, bus,
                       kva, keys);
}
std::string const kLoad = "loads: {D: {bus: B, p_kw: 60, q_kvar: 20, model: constant_impedance}}\n";
std::string const kAlone = kLoad + "batteries:\n" + battery("G", "A", kRatedKva, "p_kw: 0");

class GridFormingIn : public testing::TestWithParam<char const*> {
  protected:
    [[nodiscard]] bool waveform() const { return std::string_view{GetParam()} == "emt"; }
    std::unique_ptr<Engine> started(std::string const& elements) {
        auto engine = make(GetParam(), network(elements), kBase);
        must(engine->initialise());
        return engine;
    }
    static void until(Engine& sut, double t) { must(sut.advance(SimTime{} + SimSpan{std::llround(t * 24000)})); }
};
INSTANTIATE_TEST_SUITE_P(Solver, GridFormingIn, testing::Values("phasor", "emt"));

TEST_P(GridFormingIn, HoldsAnIslandAloneFromASettledStart) {
    auto const sut = started(kAlone);
    double const p = read(*sut, "battery.G.p_kw"), angle = read(*sut, "battery.G.angle_deg");
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-6);
    until(*sut, 1);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60, 1e-6);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-5);
    EXPECT_NEAR(read(*sut, "battery.G.p_kw"), p, 1e-3);
    EXPECT_NEAR(read(*sut, "battery.G.angle_deg"), angle, 1e-2);
    // Energy over capacity and efficiency.
    EXPECT_NEAR(read(*sut, "battery.G.soc_percent"), 50 - 100 * p / 0.95 / 100 / 3600, 1e-5);
}

TEST_P(GridFormingIn, FollowsItsDroopsAndComesBackWithTheIntegral) {
    auto const sut =
        started(kLoad + "batteries:\n" + battery("G", "A", kRatedKva, "p_kw: 0, grid_forming: {integral_ki: 100}"));
    double const p = read(*sut, "battery.G.p_kw"), q = read(*sut, "battery.G.q_kvar");
    must(sut->apply(SetMode{"G", "droop"}));
    must(sut->apply(SetParameter{"loads.D.p_kw", 100}));
    must(sut->apply(SetParameter{"loads.D.q_kvar", 60}));
    until(*sut, 3);
    double const more = (read(*sut, "battery.G.p_kw") - p) / kRatedKva,
                 var = (read(*sut, "battery.G.q_kvar") - q) / kRatedKva;
    EXPECT_GT(more, 0.2);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60 * (1 - 0.02 * more), 1e-3);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1 - 0.05 * var, 1e-4);
    must(sut->apply(SetMode{"G", "isochronous"}));
    until(*sut, 9);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60, 1e-3);
    must(sut->apply(SetParameter{"batteries.G.frequency_setpoint_hz", 60.2}));
    until(*sut, 15);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60.2, 1e-3);
}

TEST_P(GridFormingIn, SharesLoadWithAnotherOneAsTheirRatingsAndDroopsSay) {
    auto const sut = started(kLoad + "batteries:\n" + battery("G", "A", 150, "p_kw: 30") +
                             battery("H", "B", 100, "p_kw: 30, grid_forming: {droop_percent: 4}"));
    double const g = read(*sut, "battery.G.p_kw"), h = read(*sut, "battery.H.p_kw");
    must(sut->apply(SetParameter{"loads.D.p_kw", 120}));
    until(*sut, 4);
    double const g_more = read(*sut, "battery.G.p_kw") - g, h_more = read(*sut, "battery.H.p_kw") - h;
    EXPECT_GT(g_more, 30);
    EXPECT_NEAR(g_more / h_more, (150 / 0.02) / (100 / 0.04), 0.01);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60 * (1 - (g_more + h_more) / (150 / 0.02 + 100 / 0.04)), 1e-3);
}

TEST_P(GridFormingIn, SharesLoadWithAMachineByDroop) {
    // Resistive: what direct current an inductance keeps of a step swings the power for seconds.
    auto const sut =
        started("loads: {D: {bus: B, p_kw: 60, model: constant_impedance}}\n"
                "machine_types: {m: {model: classical, constants_pu: {xd1: 0.3}, inertia_h_s: 1, damping_pu: 0, "
                "governor: {droop_percent: 4, tg_s: 0.1, tt_s: 0.1}}}\n"
                "machines: {M: {bus: B, type: m, rating_kva: 100, p_kw: 30}}\nbatteries:\n" +
                battery("G", "A", 150, "p_kw: 30"));
    double const g = read(*sut, "battery.G.p_kw"), m = read(*sut, "machine.M.mechanical_kw");
    must(sut->apply(SetParameter{"loads.D.p_kw", 120}));
    until(*sut, 6);
    double const g_more = read(*sut, "battery.G.p_kw") - g, m_more = read(*sut, "machine.M.mechanical_kw") - m;
    EXPECT_GT(m_more, 8);
    EXPECT_NEAR(g_more / m_more, (150 / 0.02) / (100 / 0.04), 0.01);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60 * (1 - g_more / 150 * 0.02), 2e-3);
    EXPECT_NEAR(read(*sut, "machine.M.frequency_hz"), read(*sut, "battery.G.frequency_hz"), 2e-3);
}

/// 2 H w' = p - K angle - w / droop behind x on a stiff bus: the closed solution of the second order.
TEST_P(GridFormingIn, SwingsOnAStiffGridAsTheEquationOfSecondOrderSays) {
    constexpr double kXOhm = 0.05, kDroop = 0.1, kH = 1.0, kStep = 3.0 / kRatedKva;
    auto const sut = started("loads: {D: {bus: B, p_kw: 1}}\n"
                             "sources: {S: {bus: A, voltage_pu: 1, r_ohm: 0.0005, l_mh: 0.132629, r0_ohm: 0.0005, "
                             "l0_mh: 0.13}}\nbatteries:\n" +
                             battery("G", "A", kRatedKva,
                                     "p_kw: 15, grid_forming: {droop_percent: 10, inertia_h_s: 1, voltage_ki: 1.0e-6, "
                                     "voltage_droop_percent: 0, r_pu: 0.0001, x_pu: 0.15}"));
    double const before = read(*sut, "battery.G.p_kw"), emf = read(*sut, "battery.G.emf_pu");
    must(sut->apply(SetParameter{"batteries.G.p_kw", 18}));
    double const x = 0.15 + kXOhm / (480.0 * 480 / (kRatedKva * 1e3)), w0 = 2 * std::numbers::pi * 60;
    double const k = emf / x; // 1 p.u. behind the source's impedance
    double const natural = std::sqrt(k * w0 / (2 * kH)), decay = 1 / (4 * kH * kDroop);
    double const wd = std::sqrt(natural * natural - decay * decay);
    double largest = 0;
    for (double t = 0.02; t < 1.0; t += 0.02) {
        until(*sut, t);
        double const expected = kStep * (1 - std::exp(-decay * t) * (std::cos(wd * t) + decay / wd * std::sin(wd * t)));
        double const seen = (read(*sut, "battery.G.p_kw") - before) / kRatedKva;
        EXPECT_NEAR(seen, expected, 0.03 * kStep) << t;
        largest = std::max(largest, seen);
    }
    EXPECT_GT(largest, 1.5 * kStep); // it has swung
}

TEST_P(GridFormingIn, LimitsItsCurrentInAFaultAndHoldsTheIslandAfterIt) {
    auto const sut = started(kAlone);
    until(*sut, 0.1);
    must(sut->apply(ApplyFault{"", "B", 50, FaultType::three_phase_ground, 0, "f"}));
    double most = 0;
    for (double t = 0.101; t < 0.3; t += 0.001) {
        until(*sut, t);
        most = std::max(most, read(*sut, "line.L.from.i_a"));
    }
    EXPECT_NEAR(read(*sut, "line.L.from.i_a"), 1.2 * kRatedA, 0.02 * kRatedA);
    EXPECT_LT(most, 1.6 * kRatedA);
    EXPECT_LT(read(*sut, "bus.A.v_pu"), 0.1);
    must(sut->apply(ClearFault{"f"}));
    until(*sut, 0.8);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 0.02);
    EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60, 0.1);
}

/// Beside a converter of constant power, whose current is limited too, phasors have to search for the voltages after
/// it.
TEST_P(GridFormingIn, ComesBackAfterFaultsOfEveryKindBesidePhotovoltaics) {
    for (FaultType const type : {FaultType::three_phase_ground, FaultType::phase_ground, FaultType::phase_phase}) {
        for (double const ohm : {0.0, 0.02, 0.05, 0.1, 0.2, 0.5}) {
            auto const sut = started(kAlone + "pv: {P: {bus: B, p_kw: 20, rating_kva: 25}}\n");
            until(*sut, 0.1);
            must(sut->apply(ApplyFault{"", "B", 50, type, ohm, "f"}));
            until(*sut, 0.2);
            must(sut->apply(ClearFault{"f"}));
            until(*sut, 1.5);
            EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 1, 0.03) << ohm;
            EXPECT_NEAR(read(*sut, "battery.G.frequency_hz"), 60, 0.02) << ohm;
        }
    }
}

/// The control: what the limit withholds.
TEST_P(GridFormingIn, GivesManyTimesItsCurrentInAFaultWithoutALimit) {
    auto const sut = started(kLoad + "batteries:\n" +
                             battery("G", "A", kRatedKva, "p_kw: 0, grid_forming: {current_limit_pu: 100}"));
    must(sut->apply(ApplyFault{"", "B", 50, FaultType::three_phase_ground, 0, "f"}));
    until(*sut, 0.1);
    EXPECT_GT(read(*sut, "line.L.from.i_a"), 4 * kRatedA);
}

TEST_P(GridFormingIn, EnergisesADeadNetworkWithARampOfItsVoltage) {
    auto const sut = started(kAlone);
    must(sut->apply(StandBy{"G", true}));
    until(*sut, 0.6);
    EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 0, 1e-2);
    must(sut->apply(StandBy{"G", false}));
    until(*sut, 0.9);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 0.53, 0.06); // 0.3 of 0.5 s, a little behind
    until(*sut, 2.5);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 0.02);
    EXPECT_NEAR(read(*sut, "battery.G.p_kw"), 60, 2);
}

/// With a control that does not move it is an ideal source behind a resistance and an inductance, which is checked
/// against ngspice: the same currents through a fault, and after it.
TEST(GridFormingWaveform, IsASourceBehindItsFilterWhileItsControlRests) {
    std::string const rests =
        "p_kw: 0, grid_forming: {inertia_h_s: 1.0e12, voltage_ki: 1.0e-9, current_limit_pu: 1.0e6}";
    auto const start = [](std::string const& elements) {
        auto engine = emt::make_emt_engine(network(elements), {kBase, SimSpan{1}, 0});
        EXPECT_TRUE(engine.has_value());
        must((*engine)->initialise());
        return std::move(*engine);
    };
    auto const sut = start(kLoad + "batteries:\n" + battery("G", "A", kRatedKva, rests));
    double const base_ohm = 480.0 * 480 / (kRatedKva * 1e3);
    double const l_mh = 0.15 * base_ohm / (2 * std::numbers::pi * 60) * 1e3, r_ohm = 0.01 * base_ohm;
    auto const twin =
        start(kLoad + fmt::format("sources: {{S: {{bus: A, voltage_pu: {}, angle_deg: {}, r_ohm: {}, l_mh: {}, "
                                  "r0_ohm: {}, l0_mh: {}}}}}\n",
                                  read(*sut, "battery.G.emf_pu"), read(*sut, "battery.G.angle_deg"), r_ohm, l_mh, r_ohm,
                                  l_mh));
    ApplyFault const fault{"", "B", 50, FaultType::phase_phase_ground, 0.001, "f"};
    double most = 0, largest = 0;
    for (int step = 0; step < 4800; step += 12) {
        if (step == 1200) {
            must(sut->apply(fault));
            must(twin->apply(fault));
        }
        if (step == 2400) {
            must(sut->apply(ClearFault{"f"}));
            must(twin->apply(ClearFault{"f"}));
        }
        must(sut->advance(SimTime{} + SimSpan{step}));
        must(twin->advance(SimTime{} + SimSpan{step}));
        for (char const* phase : {"a", "b", "c"}) {
            double const i = read(*twin, fmt::format("line.L.from.i.{}", phase));
            largest = std::max(largest, std::abs(i));
            most = std::max(most, std::abs(read(*sut, fmt::format("line.L.from.i.{}", phase)) - i));
        }
    }
    EXPECT_GT(largest, 1000);
    EXPECT_LT(most, 0.02); // 1e-5 of it: the two steady states are solved in other ways
}

/// 0.3 s and 30 ms are 0.33 s but for rounding.
TEST(GridFormingEngines, PartFromTheGridWhenAMechanismEndsAtTheEndOfAStep) {
    auto engine = phasor::make_phasor_engine(
        network(kAlone + "sources: {S: {bus: B, r_ohm: 0.01, l_mh: 0.1, r0_ohm: 0.01, l0_mh: 0.1}}\n"
                         "breaker_types: {t: {mechanism_ms: 30}}\nbreakers: {Q: {line: L, end: from, type: t}}\n"),
        {.time_base = TimeBase{Rational{1, 1000}}});
    ASSERT_TRUE(engine.has_value());
    must((*engine)->initialise());
    for (int ms = 1; ms <= 400; ++ms) {
        must((*engine)->advance(SimTime{} + SimSpan{ms}));
        if (ms == 300) {
            must((*engine)->apply(SwitchBreaker{"Q", false}));
        }
    }
    EXPECT_EQ(read(**engine, "breaker.Q.position"), 1);
}

/// A step of load and a fault on an island: what the stators and filters of waveforms add is small.
TEST(GridFormingEngines, GiveTheSameAnswerWithinTheStatedBand) {
    std::string const island = "loads: {D: {bus: B, p_kw: 60, model: constant_impedance}}\nbatteries:\n" +
                               battery("G", "A", kRatedKva, "p_kw: 0, grid_forming: {inertia_h_s: 2}");
    auto waveforms = emt::make_emt_engine(network(island), {kBase, SimSpan{1}, 0});
    auto phasors = phasor::make_phasor_engine(network(island), {.time_base = kBase});
    ASSERT_TRUE(waveforms.has_value() && phasors.has_value());
    for (auto* engine : {&*waveforms, &*phasors}) {
        must((*engine)->initialise());
    }
    double step = 0, fault = 0, voltage = 0, moved = 0;
    for (int ms = 1; ms < 2000; ++ms) {
        for (auto* engine : {&*waveforms, &*phasors}) {
            if (ms == 100) {
                must((*engine)->apply(SetParameter{"loads.D.p_kw", 110}));
            } else if (ms == 1000) {
                must((*engine)->apply(ApplyFault{"", "B", 50, FaultType::three_phase_ground, 0.2, "f"}));
            } else if (ms == 1150) {
                must((*engine)->apply(ClearFault{"f"}));
            }
            must((*engine)->advance(SimTime{} + SimSpan{24 * ms}));
        }
        double const hz = read(**phasors, "battery.G.frequency_hz");
        double& most = ms < 1000 ? step : fault;
        most = std::max(most, std::abs(read(**waveforms, "battery.G.frequency_hz") - hz));
        moved = std::max(moved, std::abs(hz - 60));
        if (ms % 1000 > 200 || ms < 100) { // not in the half cycles after a discontinuity
            voltage = std::max(voltage, std::abs(read(**waveforms, "bus.B.v_pu") - read(**phasors, "bus.B.v_pu")));
        }
    }
    EXPECT_GT(moved, 0.39);
    EXPECT_LT(step, 0.005);
    EXPECT_LT(fault, 0.06); // phasors do not know the direct current of a fault, which brakes
    EXPECT_LT(voltage, 0.01);
}

/// Photovoltaics in an island that stays dark for so long come back when the battery energises it again.
class Outage : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Seconds, Outage, testing::Values(0.1, 1.0, 10.0));
TEST_P(Outage, LeavesNoConverterLost) {
    auto engine = emt::make_emt_engine(network(kLoad + "pv: {P: {bus: B, p_kw: 20, rating_kva: 25}}\nbatteries:\n" +
                                               battery("G", "A", kRatedKva, "p_kw: 40")),
                                       {kBase, SimSpan{1}, 0});
    ASSERT_TRUE(engine.has_value());
    Engine& sut = **engine;
    must(sut.initialise());
    auto const after = [&](double t) { must(sut.advance(SimTime{} + SimSpan{std::llround(t * 24000)})); };
    after(0.1);
    must(sut.apply(StandBy{"G", true}));
    after(0.1 + GetParam());
    if (GetParam() > 0.5) {
        EXPECT_NEAR(read(sut, "pv.P.p_kw"), 0, 0.2); // it does not feed the dead bus
    }
    must(sut.apply(StandBy{"G", false}));
    after(3.1 + GetParam());
    EXPECT_NEAR(read(sut, "pv.P.p_kw"), 20, 0.5);
    EXPECT_NEAR(read(sut, "bus.B.v_pu"), 1, 0.05);
}

TEST(GridForming, IsAskedForWhatOnlyItCan) {
    Network n = network(kLoad + "sources: {S: {bus: A}}\nbatteries: {G: {bus: A, capacity_kwh: 9, rating_kva: 9}}\n");
    auto engine = emt::make_emt_engine(std::move(n), {kBase, SimSpan{1}, 0});
    ASSERT_TRUE(engine.has_value());
    must((*engine)->initialise());
    EXPECT_FALSE((*engine)->apply(SetParameter{"batteries.G.droop_percent", 3}).has_value());
    EXPECT_FALSE((*engine)->apply(SetMode{"G", "droop"}).has_value());
    (void)network(
        kLoad + "sources: {S: {bus: A}}\nbatteries: {G: {bus: A, capacity_kwh: 9, rating_kva: 9, grid_forming: {}}}\n",
        false);
    (void)network(kLoad + "batteries:\n" + battery("G", "A", 90, "q_kvar: 5"), false);
}

} // namespace
} // namespace gridspace::sim
