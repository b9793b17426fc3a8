// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Averaged converters in waveforms: vehicles and generators that hold a voltage; faults inside travelling-wave lines.
#include "tests/unit/emt/emt_fixture.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

TimeBase const kBase{Rational{1, 48000}};

TEST(EmtConverters, AVehicleDrawsTheBatteryPowerOverItsEfficiencyAndStopsAtItsTarget) {
    auto const sut =
        started(network_of("buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
                           "loads: {D: {bus: A, p_kw: 1, model: constant_impedance}}\n"
                           "evs: {E: {bus: A, capacity_kwh: 0.002, battery_v: 360, max_current_a: 15, "
                           "efficiency: 0.9, soc_start_percent: 50, soc_stop_percent: 80, current_lag_s: 0.01}}\n"),
                kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "ev.E.p_kw"), 0, 1e-6);
    apply(*sut, SetParameter{"evs.E.current_a", 40}); // more than it can
    for (int n = 1; n <= 9600; ++n) {
        advance(*sut, SimTime{n});
    }
    EXPECT_NEAR(read(*sut, "ev.E.current_a"), 15, 1e-3);
    EXPECT_NEAR(read(*sut, "ev.E.p_kw"), 15 * 0.36 / 0.9, 0.01);
    EXPECT_NEAR(read(*sut, "ev.E.q_kvar"), 0, 0.01);
    // 5.4 kW for 0.2 s less the 10 ms of its lag into 2 Wh
    EXPECT_NEAR(read(*sut, "ev.E.soc_percent"), 50 + 100 * 5400 * 0.19 / 7200, 0.05);
    for (int n = 9601; n <= 24000; ++n) {
        advance(*sut, SimTime{n});
    }
    EXPECT_EQ(read(*sut, "ev.E.soc_percent"), 80);
    EXPECT_NEAR(read(*sut, "ev.E.p_kw"), 0, 1e-3);
}

TEST(EmtConverters, AGeneratorThatHoldsItsVoltageStartsSettledAndBringsItBack) {
    auto const sut =
        started(network_of("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A}}\n"
                           "lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.3}}\n"
                           "generators: {G: {bus: B, role: pv, rating_kva: 100, p_kw: 30, "
                           "voltage_setpoint_pu: 1.02}}\n"
                           "loads: {D: {bus: B, p_kw: 20, power_factor: 0.9, model: constant_impedance}}\n"),
                kBase, Rational{1, 48000});
    for (int n = 1; n <= 4800; ++n) {
        advance(*sut, SimTime{n});
        ASSERT_NEAR(read(*sut, "bus.B.v_pu"), 1.02, 1e-5) << n;
    }
    EXPECT_NEAR(read(*sut, "generator.G.p_kw"), 30, 1e-3);
    double const q = read(*sut, "generator.G.q_kvar");
    apply(*sut, SetParameter{"loads.D.q_kvar", 40});
    double lowest = 2;
    for (int n = 4801; n <= 4800 * 21; ++n) {
        advance(*sut, SimTime{n});
        lowest = std::min(lowest, read(*sut, "bus.B.v_pu"));
    }
    EXPECT_LT(lowest, 1.01);                           // the step was felt
    EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 1.02, 1e-4); // and answered
    EXPECT_NEAR(read(*sut, "generator.G.q_kvar") - q, (40 - 9.686) * 1.02 * 1.02, 0.5);
}

/// A line to a PV and a load, opened at 0.5 s for `outage_s`; then two seconds more.
void survives_an_outage(double outage_s, std::string const& load) {
    auto const sut = started(network_of("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\n"
                                        "sources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}\n"
                                        "lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.3}}\n"
                                        "breaker_types: {T: {opens: each_pole_at_current_zero}}\n"
                                        "breakers: {CB: {line: L, end: from, type: T}}\n"
                                        "pv: {P: {bus: B, p_kw: 30, rating_kva: 40}}\n" +
                                        load),
                             kBase, Rational{1, 24000});
    double const p_before = read(*sut, "pv.P.p_kw");
    std::int64_t const opened = 12000, closed = opened + std::llround(outage_s * 48000), end = closed + 96000;
    double fastest = 0, energised = 0;
    for (std::int64_t n = 2; n <= end; n += 2) {
        if (n == opened || n == closed) {
            apply(*sut, SwitchBreaker{"CB", n == closed});
        }
        advance(*sut, SimTime{n});
        if (n > opened + 24000 && n < closed) { // half a second after the grid went
            energised = std::max(energised, read(*sut, "bus.B.v_pu"));
        }
        if (n > closed + 24000) {
            fastest = std::max(fastest, std::abs(read(*sut, "bus.B.frequency_hz") - 60));
        }
    }
    EXPECT_LT(energised, 0.05) << "a dead bus is energised by nobody";
    EXPECT_LT(fastest, 0.5) << outage_s;
    EXPECT_NEAR(read(*sut, "pv.P.p_kw"), p_before, 0.01 * p_before) << outage_s;
    EXPECT_NEAR(read(*sut, "bus.B.frequency_hz"), 60, 0.01);
}

TEST(EmtConverters, APhotovoltaicComesBackAfterAnOutageOfAnyLength) {
    for (double const outage_s : {0.1, 1.0, 3.0, 10.0}) {
        survives_an_outage(outage_s, "loads: {D: {bus: B, p_kw: 20, power_factor: 0.9, model: constant_impedance}}\n");
    }
}

TEST(EmtConverters, APhotovoltaicAloneOnADeadBusEnergisesNothing) {
    survives_an_outage(3.0, "loads: {D: {bus: B, p_kw: 1, model: constant_impedance}}\n");
}

TEST(EmtConverters, AGeneratorThatWouldStartBeyondItsConverterIsRefusedByName) {
    auto const sut =
        make_emt_engine(network_of("buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\nsources: {S: {bus: A}}\n"
                                   "lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.3}}\n"
                                   "generators: {G: {bus: B, role: pv, rating_kva: 20, p_kw: 30}}\n"
                                   "loads: {D: {bus: B, p_kw: 20, model: constant_impedance}}\n"),
                        {kBase, SimSpan{1}, 0});
    ASSERT_TRUE(sut.has_value());
    auto const ok = (*sut)->initialise();
    ASSERT_FALSE(ok.has_value());
    EXPECT_NE(ok.error().message.find("generator 'G' would have to give 3"), std::string::npos) << ok.error().message;
}

TEST(EmtConverters, AnIdealSourceReportsWhatItsBusTakes) {
    auto const sut = started(network_of("buses: {A: {voltage_v: 400}}\ngenerators: {G: {bus: A, role: slack}}\n"
                                        "loads: {D: {bus: A, p_kw: 20, q_kvar: 5, model: constant_impedance}}\n"),
                             kBase, Rational{1, 48000});
    EXPECT_NEAR(read(*sut, "generator.G.p_kw"), 20, 1e-3);
    EXPECT_NEAR(read(*sut, "generator.G.q_kvar"), 5, 1e-3);
}

/// 100 km, travel time about 0.35 ms, in one piece or with a bus at a share of its length.
std::string long_line(double share) {
    auto const piece = [](std::string const& name, std::string const& from, std::string const& to, double km) {
        return name + ": {from: " + from + ", to: " + to + ", model: " + (km < 8 ? "pi" : "bergeron") +
               ", r_ohm: " + std::to_string(0.03 * km) + ", l_mh: " + std::to_string(1.0 * km) +
               ", c_nf: " + std::to_string(12 * km) + ", r0_ohm: " + std::to_string(0.2 * km) +
               ", l0_mh: " + std::to_string(3.0 * km) + ", c0_nf: " + std::to_string(8 * km) + "}";
    };
    std::string const lines = share <= 0
                                  ? piece("L", "A", "B", 100)
                                  : piece("L", "A", "M", 100 * share) + ", " + piece("R", "M", "B", 100 * (1 - share));
    return "buses: {A: {voltage_v: 220000}, B: {voltage_v: 220000}" +
           std::string{share > 0 ? ", M: {voltage_v: 220000}" : ""} +
           "}\nsources: {S: {bus: A, r_ohm: 1, l_mh: 30}, T: {bus: B, angle_deg: -10, r_ohm: 1, l_mh: 30}}\nlines: {" +
           lines + "}\n";
}

TEST(EmtLines, AFaultOfNoConductanceInsideATravellingWaveLineChangesNothing) {
    for (double const percent : {1.0, 30.0, 99.0}) {
        auto const sut = started(network_of(long_line(0)), kBase, Rational{1, 48000});
        auto const whole = started(network_of(long_line(0)), kBase, Rational{1, 48000});
        double worst = 0, peak = 0;
        for (int n = 1; n <= 1600; ++n) {
            advance(*sut, SimTime{n});
            advance(*whole, SimTime{n});
            if (n == 400) {
                apply(*sut, ApplyFault{"L", "", percent, FaultType::three_phase_ground, 1e9, "f"});
            }
            for (char const* end : {"line.L.from.i.a", "line.L.to.i.a"}) {
                worst = std::max(worst, std::abs(read(*sut, end) - read(*whole, end)));
                peak = std::max(peak, std::abs(read(*whole, end)));
            }
        }
        EXPECT_LT(worst, 0.01 * peak) << percent;
    }
}

TEST(EmtLines, AFaultInsideATravellingWaveLineIsThatAtABusThere) {
    for (double const percent : {1.0, 35.0, 99.0}) {
        ApplyFault const inside{"L", "", percent, FaultType::phase_ground, 2, "f"};
        ApplyFault const at_bus{"", "M", 0, FaultType::phase_ground, 2, "f"};
        auto const sut = started(network_of(long_line(0)), kBase, Rational{1, 48000});
        auto const oracle = started(network_of(long_line(percent / 100)), kBase, Rational{1, 48000});
        char const* far = "line.R.to.i.a";
        double worst = 0, peak = 0;
        for (int n = 1; n <= 2400; ++n) {
            advance(*sut, SimTime{n});
            advance(*oracle, SimTime{n});
            if (n == 400) {
                apply(*sut, inside);
                apply(*oracle, at_bus);
            }
            worst = std::max({worst, std::abs(read(*sut, "line.L.from.i.a") - read(*oracle, "line.L.from.i.a")),
                              std::abs(read(*sut, "line.L.to.i.a") - read(*oracle, far))});
            peak = std::max(peak, std::abs(read(*oracle, "line.L.from.i.a")));
        }
        EXPECT_LT(worst, 0.02 * peak) << percent;
        EXPECT_GT(peak, 1000) << percent;
    }
}

} // namespace
} // namespace gridspace::sim::emt
