// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The brushless exciter AC8B of IEEE 421.5-2005: one machine behind a reactance.
#include "sim/components/machine/ac8b.hpp"

#include "sim/components/machine/rotor_equations.hpp"
#include "tests/unit/components/machine_oracle.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gridspace::sim {
namespace {

using machine_oracle::compare;
using machine_oracle::kSteps;
using machine_oracle::text_of;

/// The block diagram of figure 6-8 and of PSS1A beside the machine, with stops that are hard, and FEX as annex D prints
/// it. The lag of the derivative part is written by the motion of its input.
struct BrushlessExciter : machine_oracle::Rotor {
    double tr{0.02}, kpr{80}, kir{5}, kdr{10}, tdr{0.1}, pid_max{1e9}, pid_min{-1e9}, ka{1}, ta{0.02}, vr_max{35},
        vr_min{0};
    double te{1.2}, ke{1}, kc{0.55}, kd{1.1}, vfe_max{6}, ve_min{0};
    double a{0}, b{0}; ///< saturation of the alternator
    double ks{0}, t5{1.4}, t1{0.154}, t2{0.033}, pss{0.1};
    double step{1e-4};

    enum { vm = rotor_states, integral, rate, vr, ve, wash, led, count };
    using State = std::array<double, count>;
    State x{};

    /// Through SE(E1) and SE(E2), by hand: sqrt(E SE(E)) = sqrt(B) (E - A).
    void saturate(double e1, double s1, double e2, double s2) {
        double const slope = (std::sqrt(e2 * s2) - std::sqrt(e1 * s1)) / (e2 - e1);
        b = slope * slope;
        a = e1 - std::sqrt(e1 * s1) / slope;
    }
    [[nodiscard]] double se(double e) const { return e > a ? b * (e - a) * (e - a) / e : 0; }
    [[nodiscard]] double field_voltage(State const& s) const {
        double const in = kc * stator(s).field_current / s[ve];
        double const fex = in <= 0       ? 1
                           : in <= 0.433 ? 1 - 0.577 * in
                           : in < 0.75   ? std::sqrt(0.75 - in * in)
                           : in <= 1     ? 1.732 * (1 - in)
                                         : 0;
        return s[ve] * fex;
    }
    [[nodiscard]] double highest_ve(double field_current) const {
        // KE VE + VE SE(VE) = VFEMAX - KD IFD, by bisection
        double low = 0, high = 100;
        for (int i = 0; i < 40; ++i) {
            double const middle = (low + high) / 2;
            (middle * (ke + se(middle)) < vfe_max - kd * field_current ? low : high) = middle;
        }
        return low;
    }
    [[nodiscard]] double error(State const& s) const {
        return v_ref - s[vm] + (ks > 0 ? std::clamp(s[led], -pss, pss) : 0);
    }
    [[nodiscard]] double control(State const& s) const {
        double const e = error(s);
        return kpr * e + s[integral] + (kdr > 0 ? kdr / tdr * e - s[rate] : 0);
    }
    [[nodiscard]] State slope(State const& s) const {
        Stator const o = stator(s);
        State d{};
        motion(s, o, field_voltage(s), d);
        d[vm] = (o.v - s[vm]) / tr;
        if (ks > 0) {
            d[wash] = ks * d[speed] - s[wash] / t5;
            d[led] = (s[wash] + t1 * d[wash] - s[led]) / t2;
        }
        double const e = error(s), wanted = control(s);
        d[integral] = (wanted > pid_max && e > 0) || (wanted < pid_min && e < 0) ? 0 : kir * e;
        d[rate] = kdr > 0 ? (kdr / tdr * e - s[rate]) / tdr : 0;
        d[vr] = (ka * std::clamp(wanted, pid_min, pid_max) - s[vr]) / ta;
        d[ve] = (s[vr] - s[ve] * (ke + se(s[ve])) - kd * o.field_current) / te;
        return d;
    }
    void begin_at(double v, machine_oracle::Phasor power) {
        double const field = begin(x, v, power);
        // VE by bisection: the field voltage rises with it
        double low = 0, high = 100;
        for (int i = 0; i < 60; ++i) {
            x[ve] = (low + high) / 2;
            (field_voltage(x) < field ? low : high) = x[ve];
        }
        x[vm] = v;
        x[vr] = x[ve] * (ke + se(x[ve])) + kd * field;
        double const e = kir > 0 ? 0 : x[vr] / ka / kpr;
        x[integral] = kir > 0 ? x[vr] / ka : 0;
        x[rate] = kdr > 0 ? kdr / tdr * e : 0;
        v_ref = v + e;
    }
    void advance(double seconds) {
        machine_oracle::runge_kutta(
            x, seconds, step, [this](State const& s) { return slope(s); },
            [this](State& s) {
                s[vr] = std::clamp(s[vr], vr_min, vr_max);
                s[ve] = std::clamp(s[ve], ve_min, std::max(ve_min, highest_ve(stator(s).field_current)));
            });
    }
};

/// How far the field voltages of two are apart within a second after a step of the voltage that they are asked for.
double apart(BrushlessExciter one, BrushlessExciter other, double step) {
    one.begin_at(1, {0.7, 0.1});
    other.begin_at(1, {0.7, 0.1});
    one.v_ref += step;
    other.v_ref += step;
    double most = 0;
    for (int i = 0; i < 20; ++i) {
        one.advance(0.05);
        other.advance(0.05);
        most = std::max(most, std::abs(one.field_voltage(one.x) - other.field_voltage(other.x)));
    }
    return most;
}

class BrushlessExciters : public testing::TestWithParam<std::string> {};

// The typical data of IEC 61970-302 for ExcIEEEAC8B, with a time constant of the amplifier.
constexpr char const* kTypical =
    "type: ac8b, tr_s: 0.02, kpr: 80, kir: 5, kdr: 10, tdr_s: 0.1, ka: 1, ta_s: 0.02, vr_max_pu: 35, "
    "te_s: 1.2, ke: 1, kc: 0.55, kd: 1.1, e1_pu: 6.5, se_e1: 0.3, e2_pu: 9, se_e2: 3";

TEST_P(BrushlessExciters, WithTypicalDataReachTheLimitOfTheirField) {
    BrushlessExciter oracle;
    oracle.vfe_max = 5.2;
    oracle.saturate(6.5, 0.3, 9, 3);
    compare(GetParam(), text_of(fmt::format("{}, vfe_max_pu: 5.2", kTypical)), oracle,
            {{"voltage_setpoint_pu", 1.05, 1.3}, {"voltage_setpoint_pu", 0.97, 1.3}, {"p_kw", 90, 1.3}});
    auto unlimited = oracle, unloaded = oracle, magnetized = oracle;
    unlimited.vfe_max = 1e9;
    unloaded.kc = 0;
    magnetized.kd = 0;
    EXPECT_GT(apart(oracle, unlimited, 0.05), 0.02);
    EXPECT_GT(apart(oracle, unloaded, 0.05), 0.02);
    EXPECT_GT(apart(oracle, magnetized, 0.05), 0.02);
}

TEST_P(BrushlessExciters, SaturateAndAreStabilized) {
    BrushlessExciter oracle;
    oracle.kpr = 30;
    oracle.kdr = 3;
    oracle.te = 0.5;
    oracle.kc = 0.2;
    oracle.kd = 0.4;
    oracle.vfe_max = 1e9;
    oracle.ks = 9.5;
    oracle.saturate(3, 0.3, 2, 0.1);
    compare(
        GetParam(),
        text_of("type: ac8b, tr_s: 0.02, kpr: 30, kir: 5, kdr: 3, tdr_s: 0.1, ka: 1, ta_s: 0.02, vr_max_pu: 35, te_s: "
                "0.5, kc: 0.2, kd: 0.4, e1_pu: 3, se_e1: 0.3, e2_pu: 2, se_e2: 0.1, stabilizer: {gain: 9.5, washout_s: "
                "1.4, t1_s: 0.154, t2_s: 0.033}"),
        oracle, {{"voltage_setpoint_pu", 1.03, 1.3}, {"p_kw", 90, 1.3}, {"p_kw", 60, 1.3}});
}

TEST_P(BrushlessExciters, DoNotWindUpAtTheLimitsOfControlAndAmplifier) {
    BrushlessExciter oracle;
    oracle.kir = 20;
    oracle.ka = 2;
    oracle.kdr = 0;
    oracle.te = 0.4;
    oracle.kd = 0.4;
    oracle.pid_max = 2.1;
    oracle.pid_min = 1.1;
    oracle.vr_max = 4;
    oracle.vr_min = 2;
    oracle.ve_min = 1.8;
    oracle.vfe_max = 1e9;
    compare(GetParam(),
            text_of("type: ac8b, tr_s: 0.02, kpr: 80, kir: 20, ka: 2, ta_s: 0.02, pid_min_pu: 1.1, pid_max_pu: 2.1, "
                    "vr_min_pu: 2, "
                    "vr_max_pu: 4, te_s: 0.4, kc: 0.55, kd: 0.4, ve_min_pu: 1.8"),
            oracle,
            {{"voltage_setpoint_pu", 1.1, 1.3}, {"voltage_setpoint_pu", 0.9, 1.3}, {"voltage_setpoint_pu", 1, 1.3}});
    auto amplifier = oracle, control = oracle, alternator = oracle;
    amplifier.vr_max = 1e9;
    control.pid_min = -1e9;
    alternator.ve_min = 0;
    EXPECT_GT(apart(oracle, amplifier, 0.1), 0.1);
    EXPECT_GT(apart(oracle, control, -0.1), 0.1);
    EXPECT_GT(apart(oracle, alternator, -0.1), 0.1);
}

TEST_P(BrushlessExciters, NeedNoLagOfMeasurementAndAmplifier) {
    BrushlessExciter oracle;
    oracle.tr = oracle.ta = 1e-4; // as good as none
    oracle.step = 5e-5;
    oracle.kdr = 0;
    oracle.vfe_max = 1e9;
    compare(GetParam(), text_of("type: ac8b, kpr: 80, kir: 5, ka: 1, vr_max_pu: 35, te_s: 1.2, kc: 0.55, kd: 1.1"),
            oracle, {{"voltage_setpoint_pu", 1.03, 1}, {"p_kw", 60, 1}});
}

TEST_P(BrushlessExciters, GoThroughAllModesOfTheirRectifier) {
    for (auto const& [kc, mode] : {std::pair{0.3, 1}, {1.0, 2}, {2.2, 3}}) {
        BrushlessExciter oracle;
        oracle.kir = 0; // then v_ref is above the voltage
        oracle.kdr = 0;
        oracle.te = 0.3;
        oracle.kd = 0.1;
        oracle.kc = kc;
        oracle.vfe_max = 1e9;
        auto begun = oracle;
        begun.begin_at(1, {0.7, 0.1});
        double const in = kc * begun.stator(begun.x).field_current / begun.x[BrushlessExciter::ve];
        EXPECT_EQ(in <= 0.433 ? 1 : in < 0.75 ? 2 : 3, mode) << in;
        compare(
            GetParam(),
            text_of(fmt::format(
                "type: ac8b, tr_s: 0.02, kpr: 80, ka: 1, ta_s: 0.02, vr_max_pu: 35, te_s: 0.3, kc: {}, kd: 0.1", kc)),
            oracle, {{"voltage_setpoint_pu", 1.03, 1}, {"p_kw", 60, 1}});
    }
}

INSTANTIATE_TEST_SUITE_P(Of, BrushlessExciters, testing::Values("phasor", "emt"),
                         [](auto const& of) { return of.param; });

/// IEEE 421.5-2005, annex D: FEX = 1 - 0.577 IN, sqrt(0.75 - IN^2), 1.732 (1 - IN).
TEST(Rectifier, HasThreeModes) {
    for (auto const& [in, fex] : {std::pair{-0.1, 1.0},
                                  {0.0, 1.0},
                                  {0.2, 0.8846},
                                  {0.433, 0.75016},
                                  {0.6, 0.62450},
                                  {0.75, 0.43301},
                                  {0.9, 0.1732},
                                  {1.0, 0.0},
                                  {1.2, 0.0}}) {
        EXPECT_NEAR(machines::rectified(2.5, 2.5 * in), 2.5 * fex, 2e-4 * 2.5) << in;
    }
    EXPECT_EQ(machines::rectified(0, 0.1), 0);
}

TEST(BrushlessExciter, StartsAtRest) {
    for (char const* const more :
         {"kir: 5, kdr: 10, tdr_s: 0.1, kc: 0.55, kd: 1.1", "kdr: 10, tdr_s: 0.1, kc: 0.2", "kir: 5, kc: 1",
          "kir: 5, kc: 2.2, kd: 0.1, stabilizer: {gain: 9}", "e1_pu: 2, se_e1: 0.1, e2_pu: 3, se_e2: 0.3"}) {
        Network n;
        auto const diagnostics =
            read_text(text_of(fmt::format("type: ac8b, ka: 1, kpr: 80, te_s: 1, vr_max_pu: 35, {}", more),
                              "saturation: {s10: 0.1, s12: 0.4}, "),
                      n);
        ASSERT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        auto const data = machines::machine_data(n.machines.at(0), NetworkAround{n, 0});
        auto const start = machines::steady_state(data, {1, 0}, {0.7, -0.2});
        double const angle = start.x[machines::kAngle] - std::numbers::pi / 2;
        auto const i = machine_oracle::Phasor{0.7, -0.2} * std::polar(1.0, -angle);
        machines::State dx{};
        machines::derivative(data, start.set, start.x, i.real(), i.imag(), 1, dx);
        for (double const motion : dx) {
            EXPECT_NEAR(motion, 0, 1e-12) << more;
        }
        EXPECT_GT(machines::field_voltage(data, start.x, i.real(), 1), 1.5);
    }
}

TEST(BrushlessExciter, ThatCannotGiveTheFieldOfTheStartIsRefused) {
    for (std::string const solver : {"phasor", "emt"}) {
        for (auto const& [limit, says] : {std::pair{"vr_min_pu: 20, vr_max_pu: 30", "outside its limits 20 to 30"},
                                          {"vr_max_pu: 1.5", "outside its limits 0 to 1.5"},
                                          {"vr_max_pu: 30, vfe_max_pu: 1.5", "outside its limits 0 to 1.5"},
                                          {"vr_max_pu: 30, pid_max_pu: 1", "outside its limits 0 to 1"},
                                          {"vr_max_pu: 30, ve_min_pu: 9", "below its ve_min_pu = 9"}}) {
            Network n;
            ASSERT_EQ(
                read_text(text_of(fmt::format("type: ac8b, kpr: 80, kir: 5, ka: 1, te_s: 1, {}", limit)), n).errors(),
                0);
            auto const refused = make(solver, n, kSteps)->initialise();
            ASSERT_FALSE(refused.has_value()) << limit;
            EXPECT_THAT(refused.error().message, testing::HasSubstr(says));
        }
    }
}

TEST(BrushlessExciter, MistakesInItAreNamed) {
    for (auto const& [keys, says] :
         {std::pair{"ka: 1", "kpr and kir"},
          {"ka: 1, kpr: 1, kdr: 1", "give `tdr_s` too"},
          {"ka: 1, kpr: 1, pid_min_pu: 1, pid_max_pu: 1", "pid_max_pu = 1 is not above pid_min_pu = 1"},
          {"ka: 1, kpr: 1, vr_min_pu: 9", "vr_max_pu = 5 is not above vr_min_pu = 9"},
          {"ka: 1, kpr: 1, e1_pu: 2, se_e1: 0.3, e2_pu: 3, se_e2: 0.3", "no saturation goes through"},
          {"ka: 1, kpr: 1, efd_max_pu: 6", "`efd_max_pu` is a key of `type: st1a`"},
          {"kpr: 1", "ka"}}) {
        Network n;
        auto const diagnostics = read_text(text_of(fmt::format("type: ac8b, vr_max_pu: 5, te_s: 1, {}", keys)), n);
        EXPECT_GE(diagnostics.errors(), 1) << keys;
        EXPECT_THAT(diagnostics.render(), testing::HasSubstr(says));
    }
    Network n;
    auto const diagnostics = read_text(text_of("ka: 200, efd_max_pu: 6, kpr: 1"), n);
    EXPECT_THAT(diagnostics.render(), testing::HasSubstr("`kpr` is a key of `type: ac8b`"));
}

} // namespace
} // namespace gridspace::sim
