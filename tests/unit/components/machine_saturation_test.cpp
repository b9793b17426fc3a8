// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Saturation of a machine's field by S(1.0) and S(1.2) of its open-circuit curve.
#include "sim/components/machine/saturation.hpp"

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

/// The machine behind its line with a quick regulator, its field saturated.
struct SaturatedMachine : machine_oracle::Rotor {
    double ka{50}, ta{0.05}, tr{0.02};
    enum { vm = rotor_states, efd, count };
    using State = std::array<double, count>;
    State x{};

    [[nodiscard]] double field_voltage(State const& s) const { return s[efd]; }
    [[nodiscard]] State slope(State const& s) const {
        Stator const o = stator(s);
        State d{};
        motion(s, o, s[efd], d);
        d[vm] = (o.v - s[vm]) / tr;
        d[efd] = (ka * (v_ref - s[vm]) - s[efd]) / ta;
        return d;
    }
    void begin_at(double v, machine_oracle::Phasor power) {
        x[efd] = begin(x, v, power);
        x[vm] = v;
        v_ref = v + x[efd] / ka;
    }
    void advance(double seconds) {
        machine_oracle::runge_kutta(x, seconds, 1e-4, [this](State const& s) { return slope(s); }, [](State&) {});
    }
};

constexpr char const* kRegulator = "ka: 50, ta_s: 0.05, tr_s: 0.02, efd_min_pu: -9, efd_max_pu: 9";
constexpr char const* kSaturation = "saturation: {s10: 0.11, s12: 0.48}, ";

class MachineSaturation : public testing::TestWithParam<std::string> {};

TEST_P(MachineSaturation, IsThatOfTheFieldEquation) {
    // By hand: sqrt(B) = (sqrt(1.2 0.48) - sqrt(0.11)) / 0.2 = 2.13644, A = 1 - 0.331662 / 2.13644
    SaturatedMachine oracle;
    oracle.sat_b = 4.564365;
    oracle.sat_a = 0.844759;
    compare(GetParam(), text_of(kRegulator, kSaturation), oracle,
            {{"voltage_setpoint_pu", 1.05, 1.3}, {"p_kw", 80, 1.3}, {"voltage_setpoint_pu", 0.98, 1.3}});
}

/// Without current the terminal voltage is that of the air gap, and the field needs V (1 + S(V)).
TEST_P(MachineSaturation, GivesTheOpenCircuitCurve) {
    for (auto const& [v, field] : {std::pair{0.8, 0.8}, {1.0, 1.11}, {1.2, 1.2 * 1.48}}) {
        Network n;
        std::string text = text_of(kRegulator, kSaturation);
        for (auto const& [was, is] : {std::pair<std::string, std::string>{"p_kw: 70", "p_kw: 0"},
                                      {"voltage_setpoint_pu: 1.0", fmt::format("voltage_setpoint_pu: {}", v)},
                                      {"{bus: A}", fmt::format("{{bus: A, voltage_pu: {}}}", v)}}) {
            ASSERT_NE(text.find(was), std::string::npos);
            text.replace(text.find(was), was.size(), is);
        }
        ASSERT_EQ(read_text(text, n).errors(), 0);
        auto const sut = make(GetParam(), n, kSteps);
        must(sut->initialise());
        // Waveforms turn by 2 / h tan(w h / 2) for w, 8e-5 more: so much less is the flux
        double const within = GetParam() == "emt" ? 5e-4 : 1e-9;
        EXPECT_NEAR(read(*sut, "machine.M.efd_pu"), field, within) << v;
        must(sut->advance(SimTime{} + kSteps.nearest(Rational{1, 2})));
        EXPECT_NEAR(read(*sut, "machine.M.efd_pu"), field, std::max(within, 1e-6)) << v;
    }
}

INSTANTIATE_TEST_SUITE_P(Of, MachineSaturation, testing::Values("phasor", "emt"),
                         [](auto const& of) { return of.param; });

TEST(Saturation, GoesThroughItsTwoPoints) {
    for (auto const& [e1, s1, e2, s2] :
         {std::tuple{1.0, 0.11, 1.2, 0.48}, {6.5, 0.3, 9.0, 3.0}, {4.0, 0.4, 3.0, 0.1}, {1.0, 0.0, 1.2, 0.3}}) {
        ASSERT_TRUE(machines::Saturation::fits(e1, s1, e2, s2));
        auto const sut = machines::Saturation::through(e1, s1, e2, s2);
        EXPECT_NEAR(sut.drop(e1), e1 * s1, 1e-12);
        EXPECT_NEAR(sut.drop(e2), e2 * s2, 1e-12);
        EXPECT_EQ(sut.drop(sut.a), 0);
        EXPECT_EQ(sut.drop(0), 0);
    }
    EXPECT_EQ(machines::Saturation::through(1, 0, 1.2, 0).drop(3), 0);
    EXPECT_FALSE(machines::Saturation::fits(1, 0.3, 1.2, 0.3));
}

TEST(Saturation, MistakesInItAreNamed) {
    for (auto const& [type, says] : {std::pair{"saturation: {s10: 0.2, s12: 0.2}, ", "less than 1.2 times s10"},
                                     {"saturation: {s10: 0.2}, ", "s12"},
                                     {"saturation: {s10: -0.2, s12: 1}, ", "s10"},
                                     {"saturation: {s10: 0.1, s12: 0.4}, model: classical, ", "it has no field"}}) {
        Network n;
        auto const diagnostics = read_text(text_of(kRegulator, type), n);
        EXPECT_GE(diagnostics.errors(), 1) << type;
        EXPECT_THAT(diagnostics.render(), testing::HasSubstr(says));
    }
}

} // namespace
} // namespace gridspace::sim
