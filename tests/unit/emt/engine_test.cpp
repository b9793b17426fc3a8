// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The engine on small networks: faults by symmetrical components, transformers, converters, bad networks.
#include "tests/unit/emt/emt_fixture.hpp"

#include "sim/powerflow/power_flow.hpp"

#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using testing::HasSubstr;

TimeBase const kBase{Rational{1, 48000}};
constexpr double kPeak = 16329.931618554521; // 20 kV line to line: phase peak

/// A stiff 20 kV source with x1 = 2, x0 = 5 ohm and a light load.
std::unique_ptr<Engine> faulty_source() {
    return started(
        network_of(
            "buses: {A: {voltage_v: 20000}}\n"
            "sources: {S: {bus: A, r_ohm: 0.2, l_mh: 5.305164769729845, r0_ohm: 0.5, l0_mh: 13.262911924324612}}\n"
            "loads: {D: {bus: A, p_kw: 0.001, model: constant_impedance}}\n"),
        kBase, Rational{1, 48000});
}

/// Peak of a phase current of the source over a cycle, long after the fault.
std::array<double, 3> fault_currents(FaultType type, double r_ohm) {
    auto const sut = faulty_source();
    apply(*sut, ApplyFault{"", "A", 0, type, r_ohm, "f"});
    std::array<std::size_t, 3> const i{signal_of(*sut, "source.S.i.a"), signal_of(*sut, "source.S.i.b"),
                                       signal_of(*sut, "source.S.i.c")};
    std::array<double, 3> peak{};
    for (int k = 1; k <= 48000; ++k) {
        advance(*sut, SimTime{k});
        for (std::size_t p = 0; p < 3 && k > 47200; ++p) {
            peak[p] = std::max(peak[p], std::abs(sut->value(i[p])));
        }
    }
    return peak;
}

std::complex<double> const kZ1{0.2, 2}, kZ0{0.5, 5};

TEST(EmtFaults, OfThreePhasesDrawThePositiveSequenceCurrent) {
    for (FaultType const type : {FaultType::three_phase_ground, FaultType::three_phase}) {
        auto const i = fault_currents(type, 0.5);
        EXPECT_NEAR(i[0], kPeak / std::abs(kZ1 + 0.5), 1e-3 * i[0]);
        EXPECT_NEAR(i[1], i[0], 1e-3 * i[0]);
    }
}

TEST(EmtFaults, OfOnePhaseToEarthDrawThreeTimesTheSeriesOfSequences) {
    auto const i = fault_currents(FaultType::phase_ground, 1);
    EXPECT_NEAR(i[0], 3 * kPeak / std::abs(2.0 * kZ1 + kZ0 + 3.0), 1e-3 * i[0]);
    EXPECT_LT(i[1], 1);
    EXPECT_LT(i[2], 1);
}

TEST(EmtFaults, OfTwoPhasesDrawNoEarthCurrent) {
    auto const i = fault_currents(FaultType::phase_phase, 1);
    EXPECT_LT(i[0], 1);
    EXPECT_NEAR(i[1], std::sqrt(3.0) * kPeak / std::abs(2.0 * kZ1 + 2.0), 1e-3 * i[1]);
    EXPECT_NEAR(i[2], i[1], 1e-6 * i[1]);
}

TEST(EmtFaults, OfTwoPhasesToEarthAgreeWithSymmetricalComponents) {
    double const r = 1;
    auto const i = fault_currents(FaultType::phase_phase_ground, r);
    // b and c each through r to earth: the sequence networks, each with r, in parallel.
    std::complex<double> const z1 = kZ1 + r, z2 = kZ1 + r, z0 = kZ0 + r;
    std::complex<double> const i1 = kPeak / (z1 + z2 * z0 / (z2 + z0));
    std::complex<double> const i2 = -i1 * z0 / (z2 + z0), i0 = -i1 * z2 / (z2 + z0);
    std::complex<double> const a = std::polar(1.0, 2 * std::numbers::pi / 3);
    EXPECT_NEAR(i[1], std::abs(i0 + a * a * i1 + a * i2), 1e-3 * i[1]);
    EXPECT_NEAR(i[2], std::abs(i0 + a * i1 + a * a * i2), 1e-3 * i[2]);
    EXPECT_LT(i[0], 1);
}

TEST(EmtFaults, ClearEachPhaseAtItsCurrentZero) {
    auto const sut = faulty_source();
    apply(*sut, ApplyFault{"", "A", 0, FaultType::three_phase_ground, 0.01, "f"});
    for (int k = 1; k <= 2000; ++k) {
        advance(*sut, SimTime{k});
    }
    EXPECT_LT(read(*sut, "bus.A.v_pu"), 0.02);
    apply(*sut, ClearFault{"f"});
    for (int k = 2001; k <= 3000; ++k) {
        advance(*sut, SimTime{k});
    }
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-2);
    EXPECT_LT(std::abs(read(*sut, "source.S.i.a")), 1);
}

TEST(EmtTransformers, AStarAndADeltaShiftByThirtyDegrees) {
    for (double const shift : {30.0, -30.0}) {
        auto const sut = started(
            network_of(
                "buses: {A: {voltage_v: 20000}, B: {voltage_v: 400}}\n"
                "sources: {S: {bus: A}}\n"
                "transformers: {T: {from: A, to: B, rating_kva: 100, r_percent: 1, x_percent: 4, from_winding: delta, "
                "to_winding: wye_grounded, phase_shift_deg: " +
                std::to_string(shift) + "}}\nloads: {D: {bus: B, p_kw: 0.001, model: constant_impedance}}\n"),
            kBase, Rational{1, 48000});
        EXPECT_NEAR(read(*sut, "bus.B.angle_deg"), -shift, 0.01);
        EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 1, 1e-4);
    }
}

TEST(EmtTransformers, ADeltaBlocksTheZeroSequenceOfAnEarthFault) {
    auto const sut = started(
        network_of(
            "buses: {A: {voltage_v: 20000}, B: {voltage_v: 400}}\n"
            "sources: {S: {bus: A, r_ohm: 1, l_mh: 10}}\n"
            "transformers: {T: {from: A, to: B, rating_kva: 100, r_percent: 1, x_percent: 4, from_winding: delta, "
            "to_winding: wye_grounded, phase_shift_deg: 30}}\nloads: {D: {bus: B, p_kw: 1, model: "
            "constant_impedance}}\n"),
        kBase, Rational{1, 48000});
    apply(*sut, ApplyFault{"", "B", 0, FaultType::phase_ground, 0, "f"});
    double largest = 0, zero = 0;
    for (int k = 1; k <= 4800; ++k) {
        advance(*sut, SimTime{k});
        double const a = read(*sut, "source.S.i.a"), b = read(*sut, "source.S.i.b"), c = read(*sut, "source.S.i.c");
        largest = std::max(largest, std::abs(a));
        zero = std::max(zero, std::abs(a + b + c));
    }
    EXPECT_GT(largest, 30);
    EXPECT_LT(zero, 1e-6 * largest);
}

TEST(EmtTransformers, AnImpossiblePhaseShiftIsAnError) {
    auto const made = make_emt_engine(
        network_of("buses: {A: {voltage_v: 20000}, B: {voltage_v: 400}}\nsources: {S: {bus: A}}\n"
                   "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 4, to_winding: delta}}\n"),
        {kBase, SimSpan{1}, 0});
    ASSERT_FALSE(made.has_value());
    EXPECT_THAT(made.error().message, HasSubstr("transformer 'T' cannot shift by 0 degrees"));
}

TEST(EmtNetworks, NothingConnectedToEarthIsAnError) {
    auto const made = make_emt_engine(
        network_of("buses: {A: {voltage_v: 20000}, B: {voltage_v: 400}}\nsources: {S: {bus: A}}\n"
                   "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 4, to_winding: delta, "
                   "phase_shift_deg: 30}}\n"),
        {kBase, SimSpan{1}, 0});
    ASSERT_TRUE(made.has_value());
    auto const ok = (*made)->initialise();
    ASSERT_FALSE(ok.has_value());
    EXPECT_THAT(ok.error().message, HasSubstr("to earth"));
}

TEST(EmtNetworks, ANegativeChargingIsAnErrorAndNotLeftOut) {
    Network line = network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\nsources: {S: {bus: A}}\n"
                              "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\nloads: {D: {bus: B, p_kw: 1}}\n");
    line.lines.front().c_nf = -1000; // as a MATPOWER case may have it
    auto const of_line = make_emt_engine(line, {kBase, SimSpan{1}, 0});
    ASSERT_FALSE(of_line.has_value());
    EXPECT_THAT(of_line.error().message, HasSubstr("line 'L' has a negative capacitance"));
    auto const of_transformer = make_emt_engine(
        network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\nsources: {S: {bus: A}}\n"
                   "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 4, charging_percent: -5}}\n"),
        {kBase, SimSpan{1}, 0});
    ASSERT_FALSE(of_transformer.has_value());
    EXPECT_THAT(of_transformer.error().message, HasSubstr("transformer 'T' has a negative charging_percent"));
}

TEST(EmtNetworks, TheSteadyStateIsThatOfThePowerFlow) {
    for (char const* file : {"adn_set_a.yaml", "wscc9.yaml", "kundur_two_area.yaml"}) {
        Network const network = shipped_network(file);
        auto const flow = solve_power_flow(network, SwitchState{network});
        ASSERT_TRUE(flow.has_value()) << file << ": " << describe(flow.error());
        auto const sut = started(network, kBase, Rational{1, 48000});
        for (std::size_t i = 0; i < network.buses.size(); ++i) {
            EXPECT_NEAR(read(*sut, "bus." + network.buses[i].name.name + ".v_pu"), std::abs(flow->buses[i].v), 1e-4)
                << file << ' ' << i;
        }
        double const before = read(*sut, "system.coi_hz");
        for (int k = 1; k <= 9600; ++k) {
            advance(*sut, SimTime{k});
        }
        EXPECT_NEAR(read(*sut, "system.coi_hz"), before, 1e-7) << file;
    }
}

constexpr std::string_view kLongLine =
    "buses: {A: {voltage_v: 230000}, B: {voltage_v: 230000}}\nsources: {S: {bus: A, r_ohm: 1, l_mh: 10}}\n"
    "breaker_types: {t: {}}\nbreakers: {CB: {line: L, end: from, type: t, state: STATE}}\n"
    "line_types: {ac: {r_ohm_per_km: R_KM, l_mh_per_km: 1.33, c_nf_per_km: 8.77, l0_mh_per_km: 4, c0_nf_per_km: 5}}\n"
    "lines: {L: {from: A, to: B, type: ac, length_km: 150, model: bergeron}}\n"
    "loads: {D: {bus: B, p_kw: 50000, power_factor: 0.98, model: constant_impedance}}\n";

Network long_line(std::string const& r_km, std::string const& length_km = "150") {
    std::string text{kLongLine};
    text.replace(text.find("STATE"), 5, "closed");
    text.replace(text.find("R_KM"), 4, r_km);
    text.replace(text.find("length_km: 150"), 14, "length_km: " + length_km);
    return network_of(text);
}

TEST(EmtLines, ATravellingWaveArrivesAfterItsTravelTimeAndNotBefore) {
    auto const sut = started(long_line("0.03"), kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 1, 0.05);
    for (int k = 1; k <= 960; ++k) { // it starts in its steady state
        advance(*sut, SimTime{k});
    }
    double const steady = read(*sut, "bus.B.v_pu");
    for (int k = 961; k <= 1920; ++k) {
        advance(*sut, SimTime{k});
        ASSERT_NEAR(read(*sut, "bus.B.v_pu"), steady, 2e-4) << k;
    }
    apply(*sut, ApplyFault{"", "A", 0, FaultType::three_phase_ground, 0, "f"});
    double const travel = 150 * std::sqrt(1.33e-3 * 8.77e-9); // 0.512 ms = 24.6 steps
    int seen = 0;
    for (int k = 1921; seen == 0 && k < 2000; ++k) {
        advance(*sut, SimTime{k});
        seen = std::abs(read(*sut, "bus.B.v_pu") - steady) > 0.02 ? k - 1920 : 0;
    }
    EXPECT_NEAR(seen / 48000.0, travel, 1.5 / 48000);
}

TEST(EmtLines, AStepLongerThanTheTravelTimeIsAnError) {
    auto const made = make_emt_engine(long_line("0.03", "5"), {kBase, SimSpan{1}, 0});
    ASSERT_FALSE(made.has_value());
    EXPECT_THAT(made.error().message, HasSubstr("line 'L': a wave travels along it in"));
}

TEST(EmtTransformers, EnergisingASaturableTransformerDrawsAnInrushFarAboveItsMagnetisingCurrent) {
    auto const run = [](std::string const& saturation) {
        auto const sut =
            started(network_of("buses: {A: {voltage_v: 20000}, M: {voltage_v: 20000}, B: {voltage_v: 400}}\nsources: "
                               "{S: {bus: A, r_ohm: 1, l_mh: 5}}\n"
                               "lines: {L: {from: A, to: M, r_ohm: 0.1, l_mh: 0.3}}\nbreaker_types: {t: {}}\n"
                               "breakers: {CB: {line: L, end: from, type: t}}\n"
                               "transformers: {T: {from: M, to: B, rating_kva: 1000, r_percent: 1, x_percent: 5, "
                               "magnetising_percent: 0.5" +
                               saturation + "}}\nloads: {D: {bus: B, p_kw: 1, model: constant_impedance}}\n"),
                    kBase, Rational{1, 48000});
        apply(*sut, SwitchBreaker{"CB", false});
        for (int k = 1; k <= 4000; ++k) {
            advance(*sut, SimTime{k});
        }
        apply(*sut, SwitchBreaker{"CB", true});
        double peak = 0;
        for (int k = 4001; k <= 8000; ++k) {
            advance(*sut, SimTime{k});
            for (char const* phase : {"a", "b", "c"}) {
                peak = std::max(peak, std::abs(read(*sut, std::string{"line.L.from.i."} + phase)));
            }
        }
        return peak;
    };
    double const rated = 1e6 / (std::sqrt(3.0) * 20000) * std::sqrt(2.0);
    EXPECT_GT(run(", saturation: {knee_pu: 1.2, air_core_percent: 30}"), rated);
    EXPECT_LT(run(""), 0.05 * rated); // negative control: the linear core
}

TEST(EmtLoads, OfConstantPowerHoldTheirPowerWhenTheVoltageFalls) {
    auto const sut = started(network_of("buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
                                        "loads: {D: {bus: A, p_kw: 20, q_kvar: 5, model: constant_power}}\n"),
                             kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "load.D.p_kw"), 20, 1e-3);
    apply(*sut, SetParameter{"sources.S.voltage_pu", 0.9});
    double p = 0, q = 0; // over a cycle: the step left direct current in the inductance
    for (int k = 1; k <= 24000; ++k) {
        advance(*sut, SimTime{k});
        if (k > 24000 - 800) {
            p += read(*sut, "load.D.p_kw") / 800;
            q += read(*sut, "load.D.q_kvar") / 800;
        }
    }
    EXPECT_LT(read(*sut, "bus.A.v_pu"), 0.92); // negative control: a constant impedance would draw 16.2 kW here
    EXPECT_NEAR(p, 20, 0.02);
    EXPECT_NEAR(q, 5, 0.02);
}

TEST(EmtConverters, APhotovoltaicPlantDeliversItsPowerAndStaysWithinItsCurrent) {
    auto const sut = started(
        network_of(
            "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
            "loads: {D: {bus: A, p_kw: 20, model: constant_impedance}}\npv: {P: {bus: A, p_kw: 30, rating_kva: 33}}\n"),
        kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "pv.P.p_kw"), 30, 1e-2);
    apply(*sut, ApplyFault{"", "A", 0, FaultType::three_phase_ground, 0.01, "f"});
    double peak = 0;
    for (int k = 1; k <= 4800; ++k) {
        advance(*sut, SimTime{k});
        if (k > 960) { // the filter's capacitor discharges at once
            peak = std::max(peak, std::abs(read(*sut, "pv.P.i.a")));
        }
    }
    EXPECT_LE(peak, 1.21 * 2 * 33e3 / (3 * 400 * std::sqrt(2.0 / 3)));
    EXPECT_GT(peak, 60);
}

TEST(EmtEngine, WhatIsReadDoesNotDependOnWhatElseIsRead) {
    auto const body =
        "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
        "lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.3}}\nloads: {D: {bus: B, p_kw: 30, model: constant_power}}\n";
    auto const all = started(network_of(body), kBase, Rational{1, 48000});
    auto const few = started(network_of(body), kBase, Rational{1, 48000});
    std::array<std::size_t, 2> const read{signal_of(*few, "pll.B.hz"), signal_of(*few, "load.D.p_kw")};
    few->will_read(read);
    for (auto* engine : {all.get(), few.get()}) {
        apply(*engine, SetParameter{"sources.S.frequency_hz", 61});
        for (int n = 1; n <= 480; ++n) {
            advance(*engine, SimTime{n});
        }
    }
    for (std::size_t const signal : read) {
        EXPECT_EQ(few->value(signal), all->value(signal));
    }
    EXPECT_GT(few->value(read[0]), 60.01); // the loop follows
}

TEST(EmtEngine, TheSameInputGivesTheSameBits) {
    auto const run = [] {
        auto const sut = started(shipped_network("adn_set_a.yaml"), kBase, Rational{1, 48000});
        apply(*sut, ApplyFault{"TL2", "", 30, FaultType::phase_ground, 0.05, "f"});
        apply(*sut, SwitchBreaker{"CB3", false});
        std::vector<double> out;
        for (int k = 1; k <= 4800; ++k) {
            advance(*sut, SimTime{k});
            out.push_back(read(*sut, "machine.G1.frequency_hz"));
            out.push_back(read(*sut, "ct.CT22.i.b"));
        }
        return out;
    };
    EXPECT_EQ(run(), run());
}

TEST(EmtEngine, BothCtsOfAHealthyLineReadTheSameAndADisconnectedLineNothing) {
    auto const sut = started(shipped_network("adn_set_a.yaml"), kBase, Rational{1, 48000});
    for (int k = 1; k <= 100; ++k) {
        advance(*sut, SimTime{k});
    }
    EXPECT_NEAR(read(*sut, "ct.CT21.i.a"), read(*sut, "ct.CT22.i.a"), 1e-9);
    EXPECT_NEAR(read(*sut, "line.TL2.from.i.a"), -read(*sut, "line.TL2.to.i.a"), 1e-9);
    EXPECT_NEAR(read(*sut, "line.TL2.from.i_a"), 12.66, 0.05);
    EXPECT_EQ(read(*sut, "breaker.CB3.position"), 2);
    apply(*sut, SwitchBreaker{"CB3", false});
    EXPECT_EQ(read(*sut, "breaker.CB3.position"), 0);
    for (int k = 101; k <= 1000; ++k) {
        advance(*sut, SimTime{k});
    }
    EXPECT_EQ(read(*sut, "breaker.CB3.position"), 1);
    EXPECT_NEAR(read(*sut, "ct.CT21.i.a"), 0, 1e-9);
}

} // namespace
} // namespace gridspace::sim::emt
