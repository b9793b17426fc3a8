// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Exciters and stabilizers of synchronous machines, ST1A and PSS1A of IEEE 421.5: one machine behind a reactance.
#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <complex>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <numbers>

namespace gridspace::sim {
namespace {

using Phasor = std::complex<double>;

TimeBase const kBase{Rational{1, 12000}};
constexpr double kR = 0.02, kX = 0.4; ///< of the line, p.u.
constexpr double kOmega = 2 * std::numbers::pi * 60;

std::string text_of(std::string const& avr) {
    return fmt::format("gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
                       "buses: {{A: {{voltage_v: 400}}, B: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A}}}}\n"
                       "lines: {{L: {{from: A, to: B, r_ohm: {}, l_mh: {}}}}}\n"
                       "machine_types: {{m: {{constants_pu: {{xd: 1.8, xq: 1.7, xd1: 0.3, xd2: 0.25, xq2: 0.25, xl: "
                       "0.16, ra: 0.003}}, times_s: {{td01: 8, td02: 0.03, tq02: 0.07}}, inertia_h_s: 3.5, avr: "
                       "{{{}}}}}}}\n"
                       "machines: {{M: {{bus: B, type: m, rating_kva: 100, p_kw: 70, voltage_setpoint_pu: 1.0}}}}\n",
                       kR * 1.6, kX * 1.6 / kOmega * 1e3, avr);
}

/// The machine with the block diagrams of its exciter and stabilizer, by Runge-Kutta. Leads are made of the motion of
/// their inputs; the stator is solved with the line in the machine's frame.
struct Oracle {
    // ST1A and PSS1A
    double ka{200}, ta{0.01}, tr{0.02}, lowest{-6}, highest{6}, tc{0}, tb{0}, kf{0}, tf{1};
    double vr_max{1e9}, vr_min{-1e9}, kc{0};
    double ks{0}, t5{1.4}, t1{0}, t2{0}, t3{0}, t4{0}, pss{0.1};
    // the machine of text_of()
    static constexpr double xd = 1.8, xq = 1.7, xd1 = 0.3, x2 = 0.25, xl = 0.16, ra = 0.003, td01 = 8, td02 = 0.03,
                            tq02 = 0.07, h = 3.5;
    double p_ref{0}, v_ref{0};
    Phasor source;

    enum { eq1, psi1d, psi2q, speed, angle, vm, va, lead, rate, wash, first, second, count };
    using State = std::array<double, count>;
    State x{};

    struct Stator {
        double id, iq, v, efd, torque;
        Phasor power;
    };
    [[nodiscard]] Stator stator(State const& s) const {
        double const g = (x2 - xl) / (xd1 - xl), k = (xq - x2) / (xq - xl);
        double const flux_d = g * s[eq1] + (1 - g) * s[psi1d], flux_q = k * s[psi2q];
        Phasor const e = source * std::polar(1.0, std::numbers::pi / 2 - s[angle]);
        // v + (ra + j x2) i = j flux, v = e + (r + j x) i: one impedance behind another, round to both axes
        Phasor const j{0, 1}, i = (j * Phasor{flux_d, flux_q} - e) / Phasor{ra + kR, x2 + kX};
        Phasor const v = e + Phasor{kR, kX} * i;
        Stator out{i.real(), i.imag(), std::abs(v), 0, flux_d * i.imag() - flux_q * i.real(), v * std::conj(i)};
        double const field = s[eq1] + (xd - xd1) * (out.id - (xd1 - x2) / std::pow(xd1 - xl, 2) *
                                                                 (s[psi1d] + (xd1 - xl) * out.id - s[eq1]));
        out.efd = std::clamp(s[va], out.v * vr_min, out.v * vr_max - kc * field);
        return out;
    }
    [[nodiscard]] State slope(State const& s) const {
        Stator const o = stator(s);
        State d{};
        double const damper = s[psi1d] + (xd1 - xl) * o.id - s[eq1];
        d[eq1] = (o.efd - s[eq1] - (xd - xd1) * (o.id - (xd1 - x2) / std::pow(xd1 - xl, 2) * damper)) / td01;
        d[psi1d] = -damper / td02;
        d[psi2q] = -(s[psi2q] + (xq - xl) * o.iq) / tq02;
        d[speed] = (p_ref / (1 + s[speed]) - o.torque) / (2 * h);
        d[angle] = kOmega * s[speed];
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
    void start(double v, Phasor power) { // the terminal's angle is 0
        Phasor const i = std::conj(power / v), along = v + Phasor{ra, xq} * i;
        source = v - Phasor{kR, kX} * i;
        x[angle] = std::arg(along);
        Phasor const dq = i * std::polar(1.0, std::numbers::pi / 2 - x[angle]);
        double const field = std::abs(along) + (xd - xq) * dq.real();
        x[eq1] = field - (xd - xd1) * dq.real();
        x[psi1d] = x[eq1] - (xd1 - xl) * dq.real();
        x[psi2q] = -(xq - xl) * dq.imag();
        x[vm] = v;
        x[va] = field;
        x[lead] = field / ka;
        v_ref = v + field / ka;
        p_ref = stator(x).torque;
    }
    void advance(double seconds) {
        double const step = 2e-5;
        auto const along = [](State s, State const& d, double by) {
            for (std::size_t i = 0; i < s.size(); ++i) {
                s[i] += by * d[i];
            }
            return s;
        };
        for (std::int64_t n = std::llround(seconds / step); n > 0; --n) {
            State const a = slope(x), b = slope(along(x, a, step / 2)), c = slope(along(x, b, step / 2)),
                        d = slope(along(x, c, step));
            for (auto const& [k, weight] : {std::pair{a, 1.0}, {b, 2.0}, {c, 2.0}, {d, 1.0}}) {
                x = along(x, k, weight * step / 6);
            }
            x[va] = std::clamp(x[va], lowest, highest);
        }
    }
};

struct Change {
    std::string key;
    double value;
    double seconds;
};

/// Changes of what the machine is asked for, and what it does beside the oracle.
void compare(std::string const& solver, std::string const& avr, Oracle oracle, std::vector<Change> const& changes) {
    Network n;
    auto const diagnostics = read_text(text_of(avr), n);
    ASSERT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    auto const sut = make(solver, n, kBase);
    must(sut->initialise());
    bool const waveform = solver == "emt";
    oracle.start(read(*sut, "machine.M.v_pu"),
                 {read(*sut, "machine.M.p_kw") / 100, read(*sut, "machine.M.q_kvar") / 100});
    double p_kw = 70, v_pu = 1;
    SimTime now;
    for (Change const& change : changes) {
        must(sut->apply(SetParameter{"machines.M." + change.key, change.value}));
        if (change.key == "p_kw") {
            oracle.p_ref += (change.value - p_kw) / 100;
            p_kw = change.value;
        } else {
            oracle.v_ref += change.value - v_pu;
            v_pu = change.value;
        }
        for (double t = 0.05; t < change.seconds; t += 0.05) {
            now = now + kBase.nearest(Rational{1, 20});
            must(sut->advance(now));
            oracle.advance(0.05);
            auto const stator = oracle.stator(oracle.x);
            std::string const when = fmt::format("{}, {} = {}, after {:.2f} s", solver, change.key, change.value, t);
            ASSERT_NEAR(read(*sut, "machine.M.v_pu"), stator.v, waveform ? 4e-3 : 2e-4) << when;
            ASSERT_NEAR(read(*sut, "machine.M.efd_pu"), stator.efd, waveform ? 0.1 : 0.01) << when;
            ASSERT_NEAR(read(*sut, "machine.M.frequency_hz"), 60 * (1 + oracle.x[Oracle::speed]),
                        waveform ? 0.01 : 0.001)
                << when;
        }
    }
}

class Exciters : public testing::TestWithParam<std::string> {};

TEST_P(Exciters, HaveALeadLagAndAStabilizer) {
    Oracle oracle;
    oracle.tc = 1;
    oracle.tb = 10;
    oracle.ks = 9.5;
    oracle.t1 = 0.154;
    oracle.t2 = 0.033;
    oracle.t3 = 0.1;
    oracle.t4 = 0.04;
    oracle.pss = 0.02; // the steps of power reach it
    compare(
        GetParam(),
        "ka: 200, ta_s: 0.01, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 6, tc_s: 1, tb_s: 10, stabilizer: {gain: 9.5, "
        "washout_s: 1.4, t1_s: 0.154, t2_s: 0.033, t3_s: 0.1, t4_s: 0.04, min_pu: -0.02, max_pu: 0.02}",
        oracle, {{"voltage_setpoint_pu", 1.02, 1.5}, {"p_kw", 90, 1.5}, {"p_kw", 50, 1.5}});
}

TEST_P(Exciters, HaveARateFeedback) {
    Oracle oracle;
    oracle.ta = 0.02;
    oracle.kf = 0.04;
    oracle.tf = 0.7;
    oracle.highest = 4;
    compare(GetParam(), "ka: 200, ta_s: 0.02, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 4, kf: 0.04, tf_s: 0.7", oracle,
            {{"voltage_setpoint_pu", 1.05, 1.5}, {"p_kw", 60, 1.5}, {"voltage_setpoint_pu", 1.0, 1}});
}

TEST_P(Exciters, ThatAreFedFromTheTerminalsGiveWhatTheseAndTheRectifierLetThem) {
    Oracle oracle;
    oracle.vr_max = 3;
    oracle.vr_min = 1;
    oracle.kc = 0.2;
    compare(
        GetParam(),
        "ka: 200, ta_s: 0.01, tr_s: 0.02, efd_min_pu: -6, efd_max_pu: 6, ceiling: {max_pu: 3, min_pu: 1, kc_pu: 0.2}",
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
        auto const sut = make("phasor", n, kBase);
        must(sut->initialise());
        must(sut->apply(SetParameter{"machines.M.p_kw", 95}));
        std::array<double, 2> out{};
        SimTime now;
        for (int k = 1; k <= 600; ++k) {
            now = now + kBase.nearest(Rational{1, 100});
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
        auto const refused = make(solver, n, kBase)->initialise();
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
