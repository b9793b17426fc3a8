// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/power_flow.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// A bank of 20 F, 100 V behind a converter of 20 kVA.
namespace gridspace::sim {
namespace {

using testing::HasSubstr;

constexpr double kFarad = 20, kRatedV = 100;

std::string bank_of(std::string const& keys) {
    return "supercapacitors: {C: {bus: A, capacitance_f: 20, rated_voltage_v: 100, rating_kva: 20, " + keys + "}}";
}
std::string text_of(std::string const& keys) {
    return AtOneBus::text_with(bank_of(keys));
}
Network network(std::string const& keys, std::string const& more = "") {
    return AtOneBus::network_with(bank_of(keys), more);
}

class Bank : public AtOneBus {
  public:
    Bank(std::string const& solver, std::string const& keys, std::string const& more = "")
        : AtOneBus{solver, network(keys, more)} {}
    double read(std::string const& quantity) const { return sim::read(engine(), "supercapacitor.C." + quantity); }
    double volts() const { return read("voltage_v"); }
    void set(std::string const& quantity, double value) {
        must(engine().apply(SetParameter{"supercapacitors.C." + quantity, value}));
    }
};

/// V' = -(I + V / leak) / C with I of P = (V - I R) I: Runge-Kutta at 0.1 ms.
double discharged(double v, double p_w, double esr, double leak, double t_s) {
    auto const slope = [&](double at) {
        return -((at - std::sqrt(at * at - 4 * esr * p_w)) / (2 * esr) + at / leak) / kFarad;
    };
    auto const steps = static_cast<int>(std::lround(t_s * 1e4));
    double const h = t_s / steps;
    for (int k = 0; k < steps; ++k) {
        double const a = slope(v), b = slope(v + h / 2 * a), c = slope(v + h / 2 * b), d = slope(v + h * c);
        v += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return v;
}

class SupercapacitorIn : public testing::TestWithParam<char const*> {
  protected:
    [[nodiscard]] bool waveform() const { return std::string{GetParam()} == "emt"; }
    [[nodiscard]] double kw() const { return waveform() ? 0.03 : 1e-6; } ///< tolerance of a power, kW
    [[nodiscard]] double volt() const { return waveform() ? 2e-4 : 1e-6; }
};
INSTANTIATE_TEST_SUITE_P(Solver, SupercapacitorIn, testing::Values("phasor", "emt", "fixed"));

TEST_P(SupercapacitorIn, AtConstantPowerLosesVoltageAsTheRootOfItsEnergy) {
    for (double const p : {9.0, -9.0}) {
        Bank sut{GetParam(), p > 0 ? "v_min_v: 40, v_start_v: 100, p_kw: 9, q_kvar: 3, efficiency: 0.9"
                                   : "v_min_v: 40, v_start_v: 40, p_kw: -9, q_kvar: 3, efficiency: 0.9"};
        double const of_bank = 1e3 * (p > 0 ? p / 0.9 : p * 0.9), v0 = p > 0 ? 100 : 40;
        for (double const t : {0.5, 2.0, 5.0}) {
            sut.run_to(t);
            double const v = std::sqrt(v0 * v0 - 2 * of_bank * t / kFarad);
            EXPECT_NEAR(sut.volts(), v, volt()) << t;
            EXPECT_NEAR(sut.read("current_a"), of_bank / v, waveform() ? 0.02 : 1e-4);
            EXPECT_NEAR(sut.read("soc_percent"), v * v / 100, waveform() ? 2e-3 : 1e-6);
            EXPECT_NEAR(sut.read("p_kw"), p, kw());
            EXPECT_NEAR(sut.read("q_kvar"), 3, waveform() ? 0.05 : 1e-6);
        }
    }
}

TEST_P(SupercapacitorIn, LosesInItsResistancesWhatTheCircuitSays) {
    Bank sut{GetParam(), "v_min_v: 40, v_start_v: 100, p_kw: 10, esr_ohm: 0.05, leakage_ohm: 20, efficiency: 1"};
    for (double const t : {0.5, 2.0, 5.0}) {
        sut.run_to(t);
        double const v = discharged(100, 10e3, 0.05, 20, t);
        EXPECT_NEAR(sut.volts(), v, volt()) << t;
        EXPECT_NEAR(sut.read("p_kw"), 10, kw());
        double const i = sut.read("current_a");
        EXPECT_NEAR((sut.volts() - 0.05 * i) * i, 10e3,
                    waveform() ? 0.2 : 0.01); // W: there the current of its last step
    }
    EXPECT_GT(std::sqrt(1e4 - 2 * 10e3 * 5 / kFarad) - sut.volts(), 2); // negative control: without losses
}

TEST_P(SupercapacitorIn, LeaksExponentiallyEvenWhenItStandsBy) {
    for (bool const stops : {false, true}) {
        if (stops && waveform()) {
            continue; // there what has ceased does not age
        }
        Bank sut{GetParam(), "v_min_v: 90, v_start_v: 100, leakage_ohm: 0.5, efficiency: 1"};
        if (stops) {
            must(sut.engine().apply(StandBy{"C", true}));
        }
        for (double const t : {0.5, 1.5, 4.0}) { // below its lowest voltage: 1.05 s
            sut.run_to(t);
            EXPECT_NEAR(sut.volts(), 100 * std::exp(-t / (0.5 * kFarad)), volt()) << t;
            EXPECT_EQ(sut.read("current_a"), 0);
        }
    }
}

TEST_P(SupercapacitorIn, StopsExactlyAtItsLowestVoltageAndCanBeChargedFromThere) {
    // 20 F (100^2 - 90^2) / 2 = 19 kJ at 10 kW.
    Bank sut{GetParam(), "v_min_v: 90, v_start_v: 100, p_kw: 10, q_kvar: 2, efficiency: 1"};
    sut.run_to(1.899);
    EXPECT_NEAR(sut.read("p_kw"), 10, kw());
    sut.run_to(1.91);
    EXPECT_NEAR(sut.volts(), 90, 1e-9);
    EXPECT_NEAR(sut.read("p_kw"), 0, waveform() ? 0.05 : 1e-9);
    EXPECT_NEAR(sut.read("q_kvar"), 2, waveform() ? 0.05 : 1e-6); // its converter stays
    sut.run_to(2);
    EXPECT_NEAR(sut.volts(), 90, 1e-9);
    sut.set("p_kw", -5);
    sut.run_to(3);
    EXPECT_NEAR(sut.volts(), std::sqrt(90 * 90 + 2 * 5e3 / kFarad), volt());
    EXPECT_NEAR(sut.read("p_kw"), -5, kw());
    sut.set("p_kw", 10);
    sut.run_to(3.499); // 5 kJ: half a second
    EXPECT_NEAR(sut.read("p_kw"), 10, kw());
    sut.run_to(3.6);
    EXPECT_NEAR(sut.volts(), 90, 1e-9);
    EXPECT_NEAR(sut.read("p_kw"), 0, kw());
}

TEST_P(SupercapacitorIn, FullItTakesOnlyWhatItLeaks) {
    Bank sut{GetParam(), "v_min_v: 50, v_start_v: 99, p_kw: -5, leakage_ohm: 10, efficiency: 0.8, esr_ohm: 0.01"};
    sut.run_to(1.5);
    EXPECT_NEAR(sut.volts(), kRatedV, 1e-9);
    EXPECT_NEAR(sut.read("current_a"), -10, 1e-9);
    EXPECT_NEAR(sut.read("p_kw"), -1e-3 * (100 + 0.01 * 10) * 10 / 0.8, kw());
    sut.run_to(3);
    EXPECT_NEAR(sut.volts(), kRatedV, 1e-9);
    sut.set("p_kw", -0.5); // 400 W for 1 kW of leakage: it falls
    sut.run_to(3.5);
    EXPECT_LT(sut.volts(), 99.9);
}

TEST_P(SupercapacitorIn, ItsCurrentIsLimitedByWhatIsSetAndByItsResistance) {
    Bank limited{GetParam(), "v_min_v: 50, v_start_v: 100, p_kw: 10, i_max_a: 40, esr_ohm: 0.1, efficiency: 0.9"};
    limited.run_to(1);
    double const v = 100 - 40 * 1 / kFarad; // at a constant current
    EXPECT_NEAR(limited.volts(), v, waveform() ? 1e-3 : 5e-5);
    EXPECT_NEAR(limited.read("p_kw"), 1e-3 * (v - 4) * 40 * 0.9, kw());
    limited.set("p_kw", -10);
    limited.run_to(1.5);
    EXPECT_NEAR(limited.volts(), v + 40 * 0.5 / kFarad, waveform() ? 1e-3 : 5e-5);
    EXPECT_NEAR(limited.read("p_kw"), -1e-3 * (v + 1 + 4) * 40 / 0.9, kw());
    // More than V^2 / 4R it cannot give: V / 2R, so that V falls with 2 R C.
    Bank spent{GetParam(), "v_min_v: 10, v_start_v: 100, p_kw: 20, esr_ohm: 0.25, efficiency: 1"};
    spent.run_to(2);
    EXPECT_NEAR(spent.volts(), 100 * std::exp(-2 / (2 * 0.25 * kFarad)), waveform() ? 2e-3 : 1e-4);
    EXPECT_NEAR(spent.read("p_kw"), 1e-3 * spent.volts() * spent.volts() / (4 * 0.25), kw());
}

TEST_P(SupercapacitorIn, ReachesTheLargestPowerOfAFallingVoltageWithoutAStumble) {
    Bank sut{GetParam(), "v_min_v: 20, v_start_v: 100, p_kw: 10, esr_ohm: 0.2, efficiency: 1"};
    sut.run_to(8); // from 89.4 V on it gives less than 10 kW
    double const i = sut.read("current_a"), v = sut.volts();
    EXPECT_NEAR(i, v / (2 * 0.2), 1e-3 * i);
    EXPECT_NEAR(sut.read("p_kw"), 1e-3 * v * v / (4 * 0.2), kw());
    EXPECT_LT(v, 60);
}

TEST_P(SupercapacitorIn, FollowsItsProfile) {
    Bank sut{GetParam(), "v_min_v: 50, v_start_v: 90, p_kw: 10, scale: s, efficiency: 1",
             "profiles: {s: {hours: [0, 0.0005], values: [1, -1]}}\n"};
    sut.run_to(0.9);
    EXPECT_NEAR(sut.read("p_kw"), 0, kw() + (waveform() ? 0.01 : 0));
    EXPECT_NEAR(sut.volts(), std::sqrt(90 * 90 - 2 * 4500 / kFarad), waveform() ? 1e-3 : 1e-6); // a triangle of 4.5 kJ
    sut.run_to(1.8);
    EXPECT_NEAR(sut.volts(), 90, waveform() ? 1e-3 : 1e-6);
}

TEST_P(SupercapacitorIn, InASagItLosesOnlyWhatItsConverterGives) {
    Bank sut{GetParam(), "v_min_v: 50, v_start_v: 100, p_kw: 20, efficiency: 1"};
    must(sut.engine().apply(SetParameter{"sources.S.voltage_pu", 0.6}));
    sut.run_to(0.1);
    double const before = sut.volts();
    sut.run_to(0.15);
    double const after = sut.volts(), given = sut.read("p_kw");
    EXPECT_NEAR(given, 1.2 * 20 * read(sut.engine(), "bus.A.v_pu"), 0.05);
    EXPECT_LT(given, 15.5);
    EXPECT_NEAR(kFarad * (before * before - after * after) / 2 / 0.05, 1e3 * given, waveform() ? 30 : 1);
}

TEST(Supercapacitor, RidesThroughAsABatteryDoes) {
    std::string const keys = "v_min_v: 50, v_start_v: 100, p_kw: 10";
    Bank const with{"emt", keys + ", ride_through: {category: II}"};
    Bank without{"emt", keys};
    EXPECT_EQ(with.read("in_service_share"), 1);
    auto const& signals = without.engine().signals();
    EXPECT_TRUE(std::none_of(signals.begin(), signals.end(),
                             [](SignalDef const& s) { return s.name == "supercapacitor.C.in_service_share"; }));
    EXPECT_THAT(phasor::unseen_by_phasors(network(keys + ", ride_through: {category: II}")),
                testing::ElementsAre("phasors do not know the ride-through of 'C'"));
}

TEST(Supercapacitor, StartsInThePowerFlowWithWhatItsLimitsLet) {
    auto const power = [](std::string const& keys) {
        Network const n = network(keys);
        auto const flow = solve_power_flow(n, SwitchState{n});
        EXPECT_TRUE(flow.has_value());
        return flow->units.back().p_kw;
    };
    EXPECT_NEAR(power("v_min_v: 50, v_start_v: 100, p_kw: 10"), 10, 1e-12);
    EXPECT_EQ(power("v_min_v: 50, v_start_v: 50, p_kw: 10"), 0);
    EXPECT_EQ(power("v_min_v: 50, v_start_v: 100, p_kw: -10"), 0);
}

TEST(Supercapacitor, SaysWhatIsWrongWithItsKeys) {
    auto const said = [](std::string const& keys) {
        Network n;
        return read_text(text_of(keys), n).render();
    };
    EXPECT_THAT(said("v_min_v: 120, v_start_v: 100"),
                HasSubstr("has a lowest voltage of 120 V, not below its rated 100 V"));
    EXPECT_THAT(said("v_min_v: 50, v_start_v: 40"),
                HasSubstr("starts at 40 V, which is not between its v_min_v of 50 V and its rated 100 V"));
    EXPECT_THAT(said("v_min_v: 50, v_start_v: 60, p_kw: 20, q_kvar: 10"), HasSubstr("22.36 kVA, more than its rating"));
    EXPECT_THAT(said("v_start_v: 60"), HasSubstr("lacks the key 'v_min_v'"));
    EXPECT_THAT(said("v_min_v: 50, v_start_v: 60, esr_ohm: -1"), HasSubstr("esr_ohm is -1"));
}

} // namespace
} // namespace gridspace::sim
