// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Woodward's governor of a diesel engine, DEGOV and DEGOV1 of PSS/E: a machine alone with a load.
#include "sim/components/machine/dead_time.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <array>
#include <complex>
#include <deque>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <numbers>

namespace gridspace::sim {
namespace {

constexpr double kEngineH = 1.5, kEngineX = 0.2;
TimeBase const kEngineSteps{Rational{1, 12000}};

std::string engine_text(std::string const& governor) {
    return fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\nbuses: {{A: {{voltage_v: 400}}}}\n"
        "machine_types: {{m: {{model: classical, constants_pu: {{xd1: {}, x0: 0.1}}, inertia_h_s: {}, governor: "
        "{{type: degov, {}}}}}}}\n"
        "machines: {{M: {{bus: A, type: m, rating_kva: 100, p_kw: 50}}}}\n"
        "loads: {{D: {{bus: A, p_kw: 50, model: constant_impedance}}}}\n",
        kEngineX, kEngineH, governor);
}

/// The block diagram with a delay line for the dead time, hard stops, and the swing of one machine, by Runge-Kutta. The
/// second-order blocks are written by one state and its slope each: y = (1 + T s) x, x'' from the denominator.
struct DieselEngine {
    double t1{0.01}, t2{0.02}, t3{0.2}, k{10}, t4{0.25}, t5{0.009}, t6{0.0384}, td{0.024};
    double droop{0}, te{0.05}, lowest{0}, highest{1.1};
    bool by_power{false};
    double p_ref{0.5}, load{0.5};
    bool waveform{false}; ///< there voltage and reactance go with the speed
    double flux2{0};      ///< of the machine, squared

    enum { speed, box, box_rate, act, act_rate, throttle, power, count };
    using State = std::array<double, count>;
    State x{};
    std::deque<double> line; ///< the throttle at each step of the last td seconds

    static constexpr double kStep = 2e-4;

    /// Of the resistor `load` behind the machine's constant flux.
    [[nodiscard]] double torque(double w) const {
        double const turned = waveform ? 1 + w : 1;
        return flux2 * load * turned / (1 + std::pow(kEngineX * load * turned, 2));
    }
    [[nodiscard]] State slope(State const& s, double delayed) const {
        State d{};
        double const feedback = by_power ? s[power] : s[throttle];
        double const u = -s[speed] + droop * (p_ref - feedback);
        d[box] = s[box_rate];
        d[box_rate] = (u - s[box] - t1 * s[box_rate]) / (t1 * t2);
        double const y = s[box] + t3 * s[box_rate];
        d[act] = s[act_rate];
        d[act_rate] = (y - s[act] - (t5 + t6) * s[act_rate]) / (t5 * t6);
        d[throttle] = k * (s[act] + t4 * s[act_rate]);
        d[power] = (torque(s[speed]) - s[power]) / te;
        d[speed] = (delayed * (1 + s[speed]) - torque(s[speed])) / (2 * kEngineH);
        return d;
    }
    void begin(double power_pu) {
        p_ref = power_pu;
        flux2 = power_pu / 0.5 * (1 + std::pow(kEngineX * 0.5, 2));
        x[throttle] = x[power] = power_pu;
        line.assign(static_cast<std::size_t>(std::llround(td / kStep)) + 1, power_pu);
    }
    void advance(double seconds) {
        auto const along = [](State s, State const& d, double by) {
            for (std::size_t i = 0; i < s.size(); ++i) {
                s[i] += by * d[i];
            }
            return s;
        };
        for (std::int64_t n = std::llround(seconds / kStep); n > 0; --n) {
            double const from = line[0], to = line.size() > 1 ? line[1] : from, middle = (from + to) / 2;
            State const a = slope(x, from), b = slope(along(x, a, kStep / 2), middle),
                        c = slope(along(x, b, kStep / 2), middle), d = slope(along(x, c, kStep), to);
            for (auto const& [at, weight] : {std::pair{a, 1.0}, {b, 2.0}, {c, 2.0}, {d, 1.0}}) {
                x = along(x, at, weight * kStep / 6);
            }
            x[throttle] = std::clamp(x[throttle], lowest, highest);
            line.pop_front();
            line.push_back(x[throttle]);
        }
    }
};

/// Load steps; the largest differences between machine and oracle, every 20 ms.
struct Differences {
    double hz{0}, kw{0}, least_hz{60};
};
Differences differences(std::string const& solver, std::string const& governor, DieselEngine oracle,
                        std::vector<double> const& loads_kw, double each_s = 3) {
    Network n;
    auto const diagnostics = read_text(engine_text(governor), n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    auto const sut = make(solver, n, kEngineSteps);
    must(sut->initialise());
    oracle.waveform = solver == "emt";
    oracle.begin(read(*sut, "machine.M.mechanical_kw") / 100);
    Differences out;
    SimTime now;
    for (double const load_kw : loads_kw) {
        must(sut->apply(SetParameter{"loads.D.p_kw", load_kw}));
        oracle.load = load_kw / 100;
        for (double t = 0; t < each_s; t += 0.02) {
            now = now + kEngineSteps.nearest(Rational{1, 50});
            must(sut->advance(now));
            oracle.advance(0.02);
            double const hz = read(*sut, "machine.M.frequency_hz");
            out.least_hz = std::min(out.least_hz, hz);
            out.hz = std::max(out.hz, std::abs(hz - 60 * (1 + oracle.x[DieselEngine::speed])));
            double const wanted = 100 * oracle.line[0] * (1 + oracle.x[DieselEngine::speed]);
            out.kw = std::max(out.kw, std::abs(read(*sut, "machine.M.mechanical_kw") - wanted));
        }
    }
    return out;
}

class DieselGovernors : public testing::TestWithParam<std::string> {
  protected:
    void expect_close(Differences const& a) {
        EXPECT_LT(a.hz, GetParam() == "emt" ? 0.005 : 1e-3);
        EXPECT_LT(a.kw, 0.1);
        RecordProperty("worst_hz", fmt::format("{:.2g}", a.hz));
        RecordProperty("worst_kw", fmt::format("{:.2g}", a.kw));
    }
};

constexpr char const* kWoodward =
    "t1_s: 0.01, t2_s: 0.02, t3_s: 0.2, k: 10, t4_s: 0.25, t5_s: 0.009, t6_s: 0.0384, td_s: 0.024, "
    "gate_min_pu: 0, gate_max_pu: 1.1";

TEST_P(DieselGovernors, IsDegov) {
    auto const a = differences(GetParam(), kWoodward, {}, {60, 90, 30, 50});
    expect_close(a);
    EXPECT_LT(a.least_hz, 58.5); // it was a step
}

TEST_P(DieselGovernors, HasStops) {
    DieselEngine oracle;
    oracle.lowest = 0.4;
    oracle.highest = 0.7;
    std::string limited{kWoodward};
    limited.resize(limited.find("gate_min_pu"));
    expect_close(
        differences(GetParam(), limited + "gate_min_pu: 0.4, gate_max_pu: 0.7", oracle, {75, 50, 35, 50}, 1.5));
}

TEST_P(DieselGovernors, HasALongDeadTime) {
    DieselEngine oracle;
    oracle.td = 0.12;
    oracle.k = 3;
    std::string const late = "t1_s: 0.01, t2_s: 0.02, t3_s: 0.2, k: 3, t4_s: 0.25, t5_s: 0.009, t6_s: 0.0384, "
                             "gate_min_pu: 0, gate_max_pu: 1.1, td_s: 0.12";
    expect_close(differences(GetParam(), late, oracle, {60, 80, 50}, 4));
    oracle.td = 0; // without it: another machine
    EXPECT_GT(differences(GetParam(), late, oracle, {60}).hz, 0.1);
}

TEST_P(DieselGovernors, IsDegov1WithADroop) {
    for (bool const by_power : {false, true}) {
        DieselEngine oracle;
        oracle.droop = 0.04;
        oracle.by_power = by_power;
        expect_close(differences(GetParam(),
                                 fmt::format("{}, droop_percent: 4, droop_control: {}", kWoodward,
                                             by_power ? "electric_power, te_s: 0.05" : "throttle"),
                                 oracle, {60, 90, 30}));
    }
}

TEST_P(DieselGovernors, HoldTheFrequencyOrShareByDroop) {
    for (auto const& [more, mode, droop] : {std::tuple{"", "", 0.0},
                                            {", droop_percent: 4", "", 0.04},
                                            {", droop_percent: 4, droop_control: electric_power", "", 0.04},
                                            {", droop_percent: 4", "isochronous", 0.0}}) {
        Network n;
        ASSERT_EQ(read_text(engine_text(std::string{kWoodward} + more), n).errors(), 0);
        auto const sut = make(GetParam(), n, kEngineSteps);
        must(sut->initialise());
        if (*mode != 0) {
            must(sut->apply(SetMode{"M", mode}));
        }
        double const before = read(*sut, "machine.M.mechanical_kw") / 100;
        must(sut->apply(SetParameter{"loads.D.p_kw", 80}));
        must(sut->advance(SimTime{} + kEngineSteps.nearest(Rational{25, 1})));
        double const hz = read(*sut, "machine.M.frequency_hz"), power = read(*sut, "machine.M.mechanical_kw") / 100;
        bool const by_power = std::string{more}.find("electric") != std::string::npos;
        EXPECT_NEAR(hz, 60 * (1 - droop * ((by_power ? power : power * 60 / hz) - before)), 1e-3) << more << mode;
        EXPECT_GT(power, before + 0.25);
    }
}

TEST_P(DieselGovernors, WithoutADroopHaveNoPowerToBeTold) {
    Network n;
    ASSERT_EQ(read_text(engine_text(kWoodward), n).errors(), 0);
    auto const sut = make(GetParam(), n, kEngineSteps);
    must(sut->initialise());
    must(sut->apply(SetParameter{"machines.M.frequency_setpoint_hz", 60.5}));
    must(sut->advance(SimTime{} + kEngineSteps.nearest(Rational{20, 1})));
    EXPECT_NEAR(read(*sut, "machine.M.frequency_hz"), 60.5, 1e-3);
    for (char const* const quantity : {"p_kw", "droop_percent"}) {
        auto const refused = n.machines.at(0).refuses(quantity, NetworkAround{n}, true);
        ASSERT_TRUE(refused.has_value()) << quantity;
        EXPECT_THAT(std::string{refused->hint}, testing::HasSubstr("droop_percent"));
    }
    EXPECT_TRUE(n.machines.at(0).refuses_mode("droop", NetworkAround{n}).has_value());
    EXPECT_FALSE(n.machines.at(0).refuses_mode("isochronous", NetworkAround{n}).has_value());
}

INSTANTIATE_TEST_SUITE_P(Of, DieselGovernors, testing::Values("phasor", "emt"),
                         [](auto const& of) { return of.param; });

/// The transfer function against exp(-j w T), by solving (j w T - A) m = B for the columns that derivative() shows.
TEST(DeadTime, PassesSinesUntilOneAndAHalfRadiansPerOrder) {
    using machines::DeadTime;
    constexpr std::size_t kN = DeadTime::kOrder;
    using Column = std::array<double, kN>;
    auto const motion = [](Column const& m, double u) {
        Column out{};
        DeadTime::derivative(m.data(), u, 1, out.data());
        return out;
    };
    for (auto const& [wt, error] : {std::pair{1.0, 3e-9}, {3.0, 1.1e-4}, {5.0, 0.012}}) {
        std::array<std::array<std::complex<double>, kN + 1>, kN> rows{};
        Column const b = motion({}, 1);
        for (std::size_t j = 0; j < kN; ++j) {
            Column unit{};
            unit[j] = 1;
            Column const a = motion(unit, 0);
            for (std::size_t i = 0; i < kN; ++i) {
                rows[i][j] = std::complex<double>{-a[i], i == j ? wt : 0};
                rows[i][kN] = b[i];
            }
        }
        for (std::size_t c = 0; c < kN; ++c) { // Gauss and Jordan; the diagonal is never 0
            for (std::size_t r = 0; r < kN; ++r) {
                auto const by = rows[r][c] / rows[c][c];
                for (std::size_t k = c; r != c && k <= kN; ++k) {
                    rows[r][k] -= by * rows[c][k];
                }
            }
        }
        std::complex<double> out;
        for (std::size_t i = 0; i < kN; ++i) {
            out += rows[i][kN] / rows[i][i];
        }
        EXPECT_LT(std::abs(out - std::polar(1.0, -wt)), error) << wt;
        EXPECT_GT(std::abs(out - std::polar(1.0, -wt)), error / 3) << wt;
    }
    std::array<double, kN> const rest{0.7, 0, 0, 0, 0};
    EXPECT_EQ(DeadTime::output(rest.data()), 0.7);
    for (double const d : motion(rest, 0.7)) {
        EXPECT_EQ(d, 0);
    }
}

TEST(DieselGovernor, ThatCannotGiveWhatItIsToGiveIsRefused) {
    for (std::string const solver : {"phasor", "emt"}) {
        Network n;
        ASSERT_EQ(read_text(engine_text("k: 10, gate_min_pu: 0, gate_max_pu: 0.4"), n).errors(), 0);
        auto const refused = make(solver, n, kEngineSteps)->initialise();
        ASSERT_FALSE(refused.has_value());
        EXPECT_THAT(refused.error().message, testing::HasSubstr("outside the limits of its governor, 0 to 0.4"));
    }
}

TEST(DieselGovernor, MistakesInItAreNamed) {
    for (auto const& [governor, says] : {std::pair{"t1_s: 0.1, k: 1", "needs t1_s and t2_s"},
                                         {"k: 1, t3_s: 1", "give `t1_s` and `t2_s` too"},
                                         {"k: 1, t4_s: 1", "give `t5_s` too"},
                                         {"k: 1, td_s: 0.0001", "a dead time of 0.0001 s is shorter than 1 ms"},
                                         {"k: 1, te_s: 1", "add `droop_control: electric_power`"},
                                         {"k: 1, tt_s: 1", "`tt_s` is a key of `type: tgov1`"},
                                         {"td_s: 0.1", "lacks the key 'k'"}}) {
        Network n;
        auto const diagnostics = read_text(engine_text(governor), n);
        EXPECT_GE(diagnostics.errors(), 1) << governor;
        EXPECT_THAT(diagnostics.render(), testing::HasSubstr(says));
    }
    Network n;
    std::string text = engine_text("td_s: 0.1");
    text.erase(text.find("type: degov, "), 13);
    EXPECT_THAT(read_text(text, n).render(), testing::HasSubstr("`td_s` is a key of `type: degov`"));
}

} // namespace
} // namespace gridspace::sim
