// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Exciters and stabilizers of synchronous machines, ST1A and PSS1A of IEEE 421.5: one machine behind a reactance.
#include "tests/unit/components/machine_oracle.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gridspace::sim {
namespace {

using machine_oracle::compare;
using machine_oracle::kSteps;
using machine_oracle::text_of;

/// Block diagrams of exciter and stabilizer beside the machine. Leads are made of the motion of their inputs.
struct StaticExciter : machine_oracle::Rotor {
    // ST1A and PSS1A
    double ka{200}, ta{0.01}, tr{0.02}, lowest{-6}, highest{6}, tc{0}, tb{0}, kf{0}, tf{1};
    double vr_max{1e9}, vr_min{-1e9}, kc{0};
    double ks{0}, t5{1.4}, t1{0}, t2{0}, t3{0}, t4{0}, pss{0.1};

    enum { vm = rotor_states, va, lead, rate, wash, first, second, count };
    using State = std::array<double, count>;
    State x{};

    [[nodiscard]] double field_voltage(State const& s) const {
        Stator const o = stator(s);
        return std::clamp(s[va], o.v * vr_min, o.v * vr_max - kc * o.field_current);
    }
    [[nodiscard]] State slope(State const& s) const {
        Stator const o = stator(s);
        State d{};
        motion(s, o, field_voltage(s), d);
        d[vm] = (o.v - s[vm]) / tr;
        double stabilizing = 0;
        if (ks > 0) { // washed: t5 w' + w = t5 ks speed'; then t2 y' + y = w + t1 w', t4 z' + z = y + t3 y'
            d[wash] = ks * d[speed] - s[wash] / t5;
            d[first] = (s[wash] + t1 * d[wash] - s[first]) / t2;
            d[second] = (s[first] + t3 * d[first] - s[second]) / t4;
            stabilizing = std::clamp(s[second], -pss, pss);
        }
        double const error = v_ref - s[vm] + stabilizing - s[rate];
        double const led = tb > 0 ? s[lead] + tc / tb * (error - s[lead]) : error;
        d[lead] = tb > 0 ? (error - s[lead]) / tb : 0;
        d[va] = (ka * led - s[va]) / ta;
        if ((s[va] >= highest && d[va] > 0) || (s[va] <= lowest && d[va] < 0)) {
            d[va] = 0;
        }
        d[rate] = kf > 0 ? (kf * d[va] - s[rate]) / tf : 0;
        return d;
    }
    void begin_at(double v, machine_oracle::Phasor power) {
        double const field = begin(x, v, power);
        x[vm] = v;
        x[va] = field;
        x[lead] = field / ka;
        v_ref = v + field / ka;
    }
    void advance(double seconds) {
        machine_oracle::runge_kutta(
            x, seconds, 2e-5, [this](State const& s) { return slope(s); },
            [this](State& s) { s[va] = std::clamp(s[va], lowest, highest); });
    }
};

class Exciters : public testing::TestWithParam<std::string> {};

TEST_P(Exciters, HaveALeadLagAndAStabilizer) {
    StaticExciter oracle;
    oracle.tc = 1;
    oracle.tb = 10;
    oracle.ks = 9.5;
    oracle.t1 = 0.154;
    oracle.t2 = 0.033;
    oracle.t3 = 0.1;
    oracle.t4 = 0.04;
    oracle.pss = 0.02; // the steps of power reach it
    compare(GetParam(),
            text_of("ka: 200, ta_s: 0.01, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 6, tc_s: 1, tb_s: 10, stabilizer: "
                    "{gain: 9.5, "
                    "washout_s: 1.4, t1_s: 0.154, t2_s: 0.033, t3_s: 0.1, t4_s: 0.04, min_pu: -0.02, max_pu: 0.02}"),
            oracle, {{"voltage_setpoint_pu", 1.02, 1.5}, {"p_kw", 90, 1.5}, {"p_kw", 50, 1.5}});
}

TEST_P(Exciters, HaveARateFeedback) {
    StaticExciter oracle;
    oracle.ta = 0.02;
    oracle.kf = 0.04;
    oracle.tf = 0.7;
    oracle.highest = 4;
    compare(GetParam(), text_of("ka: 200, ta_s: 0.02, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 4, kf: 0.04, tf_s: 0.7"),
            oracle, {{"voltage_setpoint_pu", 1.05, 1.5}, {"p_kw", 60, 1.5}, {"voltage_setpoint_pu", 1.0, 1}});
}

TEST_P(Exciters, ThatAreFedFromTheTerminalsGiveWhatTheseAndTheRectifierLetThem) {
    StaticExciter oracle;
    oracle.vr_max = 3;
    oracle.vr_min = 1;
    oracle.kc = 0.2;
    compare(GetParam(),
            text_of("ka: 200, ta_s: 0.01, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 6, ceiling: {max_pu: 3, min_pu: 1, "
                    "kc_pu: 0.2}"),
            oracle, {{"voltage_setpoint_pu", 1.05, 1.2}, {"voltage_setpoint_pu", 0.95, 1.2}, {"p_kw", 80, 1.2}});
}

INSTANTIATE_TEST_SUITE_P(Of, Exciters, testing::Values("phasor", "emt"), [](auto const& of) { return of.param; });

/// Kundur, Power System Stability and Control, 1994, examples 12.3 to 12.5: a fast exciter takes the damping of a
/// machine behind a long line, a stabilizer gives it back.
TEST(Stabilizer, DampsWhatAFastExciterUndamps) {
    auto const swing = [](std::string const& stabilizer) { // largest deviation of the speed, early and late, Hz
        Network n;
        auto const avr = "ka: 200, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 6" + stabilizer;
        EXPECT_EQ(read_text(text_of(avr), n).errors(), 0);
        auto const sut = make("phasor", n, kSteps);
        must(sut->initialise());
        must(sut->apply(SetParameter{"machines.M.p_kw", 95}));
        std::array<double, 2> out{};
        SimTime now;
        for (int k = 1; k <= 600; ++k) {
            now = now + kSteps.nearest(Rational{1, 100});
            must(sut->advance(now));
            double& largest = out.at(k <= 150 ? 0 : 1);
            if (k <= 150 || k > 450) {
                largest = std::max(largest, std::abs(read(*sut, "machine.M.frequency_hz") - 60));
            }
        }
        return out[1] / out[0];
    };
    double const without = swing(""),
                 with = swing(", stabilizer: {gain: 9.5, washout_s: 1.4, t1_s: 0.154, t2_s: 0.033}");
    EXPECT_LT(with, 0.1);
    EXPECT_GT(without, 3 * with);
}

TEST(Exciter, ThatCannotGiveTheFieldOfTheStartIsRefused) {
    for (std::string const solver : {"phasor", "emt"}) {
        Network n;
        ASSERT_EQ(read_text(text_of("ka: 200, efd_min_pu: -6, efd_max_pu: 6, ceiling: {max_pu: 1.5, kc_pu: 0.1}"), n)
                      .errors(),
                  0);
        auto const refused = make(solver, n, kSteps)->initialise();
        ASSERT_FALSE(refused.has_value());
        EXPECT_THAT(refused.error().message, testing::HasSubstr("outside its limits 0 to 1.3"));
    }
}

TEST(Exciter, MistakesInItAreNamed) {
    for (auto const& [keys, says] : {std::pair{"tc_s: 1", "a lead needs a lag"},
                                     {"kf: 0.1", "a loop at one instant"},
                                     {"ceiling: {max_pu: 2, min_pu: 2}", "min_pu = 2 is not below max_pu = 2"},
                                     {"ceiling: {min_pu: 2}", "max_pu"},
                                     {"stabilizer: {washout_s: 3}", "gain"},
                                     {"stabilizer: {gain: 5, t3_s: 1}", "give `t4_s` too"},
                                     {"stabilizer: {gain: 5, max_pu: -1}", "max_pu"}}) {
        Network n;
        auto const diagnostics = read_text(text_of(fmt::format("ka: 200, efd_max_pu: 6, {}", keys)), n);
        EXPECT_GE(diagnostics.errors(), 1) << keys;
        EXPECT_THAT(diagnostics.render(), testing::HasSubstr(says));
    }
}

} // namespace
} // namespace gridspace::sim
