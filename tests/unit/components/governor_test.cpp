// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Governors and turbines of synchronous machines: TGOV1 and GAST of PSS/E, alone with a load.
#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gridspace::sim {
namespace {

constexpr double kH = 4, kX = 0.2;
TimeBase const kBase{Rational{1, 12000}};

std::string text_of(std::string const& governor) {
    return fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\nbuses: {{A: {{voltage_v: 400}}}}\n"
        "machine_types: {{m: {{model: classical, constants_pu: {{xd1: {}, x0: 0.1}}, inertia_h_s: {}, governor: "
        "{{{}}}}}}}\n"
        "machines: {{M: {{bus: A, type: m, rating_kva: 100, p_kw: 50}}}}\n"
        "loads: {{D: {{bus: A, p_kw: 50, model: constant_impedance}}}}\n",
        kX, kH, governor);
}

/// The block diagrams of PSS/E's TGOV1 and GAST, and the swing of one machine, by Runge-Kutta: the lead of the turbine
/// written by the motion of its input, which is another form than the machine's.
struct Oracle {
    double droop{0.05}, t1{0.5}, t2{0}, t3{1}, damping{0}, ki{0}, lowest{-1e9}, highest{1e9};
    bool gas{false};
    double at{1}, kt{2}, t_exhaust{3}; ///< GAST: T2 is t3 above
    double p_ref{0.5}, load{0.5};
    bool waveform{false}; ///< there voltage and reactance go with the speed
    /// Of the resistor `load` behind the constant flux that gives `p_ref` to half of it.
    [[nodiscard]] double torque(double speed) const {
        double const w = waveform ? 1 + speed : 1;
        return p_ref / 0.5 * (1 + std::pow(kX * 0.5, 2)) * load * w / (1 + std::pow(kX * load * w, 2));
    }
    struct State {
        double speed{0}, valve{0.5}, turbine{0.5}, exhaust{0.5}, integral{0};
    } x;

    [[nodiscard]] double wanted(State const& s) const { return p_ref - s.speed / droop - s.integral; }
    [[nodiscard]] double permitted(State const& s) const { return gas ? at + kt * (at - s.exhaust) : 1e9; }
    [[nodiscard]] State slope(State const& s) const {
        State d{0, 0, 0, 0, 0};
        d.valve = (std::min(wanted(s), permitted(s)) - s.valve) / t1;
        if ((s.valve >= highest && d.valve > 0) || (s.valve <= lowest && d.valve < 0)) {
            d.valve = 0;
        }
        // T3 y' + y = v + T2 v'
        d.turbine = (s.valve + t2 * d.valve - s.turbine) / t3;
        d.exhaust = (s.turbine - s.exhaust) / t_exhaust;
        bool const held =
            (s.speed < 0 && wanted(s) > std::min(permitted(s), highest)) || (s.speed > 0 && wanted(s) < lowest);
        d.integral = held ? 0 : ki * s.speed;
        d.speed = (s.turbine - damping * s.speed - torque(s.speed)) / (2 * kH);
        return d;
    }
    void advance(double seconds) {
        double const h = 1e-4;
        auto const along = [](State const& s, State const& d, double by) {
            return State{s.speed + by * d.speed, s.valve + by * d.valve, s.turbine + by * d.turbine,
                         s.exhaust + by * d.exhaust, s.integral + by * d.integral};
        };
        for (std::int64_t n = std::llround(seconds / h); n > 0; --n) {
            State const a = slope(x), b = slope(along(x, a, h / 2)), c = slope(along(x, b, h / 2)),
                        d = slope(along(x, c, h));
            for (auto const& [k, weight] : {std::pair{a, 1.0}, {b, 2.0}, {c, 2.0}, {d, 1.0}}) {
                x = along(x, k, weight * h / 6);
            }
            x.valve = std::clamp(x.valve, lowest, highest);
        }
    }
    [[nodiscard]] double frequency_hz() const { return 60 * (1 + x.speed); }
    [[nodiscard]] double power_kw() const { return 100 * (x.turbine - damping * x.speed); }
};

/// Load steps, and what the machine does beside the oracle.
void compare(std::string const& solver, std::string const& governor, Oracle oracle, std::vector<double> const& loads_kw,
             double each_s = 8) {
    Network n;
    auto const diagnostics = read_text(text_of(governor), n);
    ASSERT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    auto const sut = make(solver, n, kBase);
    must(sut->initialise());
    oracle.waveform = solver == "emt";
    oracle.p_ref = read(*sut, "machine.M.mechanical_kw") / 100;
    oracle.x.valve = oracle.x.turbine = oracle.x.exhaust = oracle.p_ref;
    SimTime now;
    for (double const load_kw : loads_kw) {
        must(sut->apply(SetParameter{"loads.D.p_kw", load_kw}));
        oracle.load = load_kw / 100;
        for (double t = 0; t < each_s; t += 0.25) {
            now = now + kBase.nearest(Rational{1, 4});
            must(sut->advance(now));
            oracle.advance(0.25);
            ASSERT_NEAR(read(*sut, "machine.M.frequency_hz"), oracle.frequency_hz(), 0.01)
                << solver << ", " << load_kw << " kW, " << t << " s";
            ASSERT_NEAR(read(*sut, "machine.M.mechanical_kw"), oracle.power_kw(), 0.3)
                << solver << ", " << load_kw << " kW, " << t << " s";
        }
    }
}

class Governors : public testing::TestWithParam<std::string> {};

TEST_P(Governors, IsTgov1WithLeadLimitsAndDamping) {
    Oracle oracle;
    oracle.t2 = 0.6;
    oracle.t3 = 2;
    oracle.damping = 0.5;
    oracle.lowest = 0.3;
    oracle.highest = 0.7;
    // 85 kW are more than its gate lets through, 10 kW less: it sags and rises, and comes back
    compare(GetParam(),
            "droop_percent: 5, tg_s: 0.5, lead_s: 0.6, tt_s: 2, damping_pu: 0.5, gate_min_pu: 0.3, gate_max_pu: 0.7",
            oracle, {60, 85, 60, 10, 50}, 4);
}

TEST_P(Governors, IsGastWithALoadLimit) {
    Oracle oracle;
    oracle.t1 = oracle.t3 = 0.4;
    oracle.gas = true;
    oracle.at = 0.65;
    oracle.highest = 1;
    oracle.lowest = -0.05;
    compare(GetParam(),
            "droop_percent: 5, tg_s: 0.4, tt_s: 0.4, gate_min_pu: -0.05, gate_max_pu: 1, load_limit: {power_pu: 0.65, "
            "gain: 2, t_s: 3}",
            oracle, {60, 75, 55}, 6);
}

TEST_P(Governors, AnIntegralDoesNotWindUpAtALimit) {
    Oracle oracle;
    oracle.t1 = 0.2;
    oracle.t3 = 0.3;
    oracle.ki = 2;
    oracle.highest = 0.6;
    compare(GetParam(), "droop_percent: 5, tg_s: 0.2, tt_s: 0.3, integral_ki: 2, gate_max_pu: 0.6", oracle,
            {55, 70, 40}, 6);
}

INSTANTIATE_TEST_SUITE_P(Of, Governors, testing::Values("phasor", "emt"), [](auto const& of) { return of.param; });

TEST(Governor, ThatCannotGiveWhatItIsToGiveIsRefused) {
    for (std::string const solver : {"phasor", "emt"}) {
        for (auto const& [governor, limits] : {std::pair{"gate_max_pu: 0.4", "-inf to 0.4"},
                                               {"gate_min_pu: 0.6", "0.6 to inf"},
                                               {"load_limit: {power_pu: 0.45}", "-inf to 0.45"}}) {
            Network n;
            ASSERT_EQ(read_text(text_of(std::string{"tt_s: 1, "} + governor), n).errors(), 0);
            auto const refused = make(solver, n, kBase)->initialise();
            ASSERT_FALSE(refused.has_value()) << governor;
            EXPECT_THAT(
                refused.error().message,
                testing::HasSubstr(fmt::format(" p.u. at the start, outside the limits of its governor, {}", limits)));
        }
    }
}

TEST(Governor, MistakesInItAreNamed) {
    for (auto const& [governor, says] :
         {std::pair{"gate_min_pu: 0.5, gate_max_pu: 0.5", "gate_max_pu = 0.5 is not above gate_min_pu = 0.5"},
          {"lead_s: 1", "a lead needs the lag that it leads"},
          {"load_limit: {power_pu: 0}", "power_pu"},
          {"load_limit: {t_s: 0}", "t_s"}}) {
        Network n;
        auto const diagnostics = read_text(text_of(governor), n);
        EXPECT_GE(diagnostics.errors(), 1) << governor;
        EXPECT_THAT(diagnostics.render(), testing::HasSubstr(says));
    }
}

} // namespace
} // namespace gridspace::sim
