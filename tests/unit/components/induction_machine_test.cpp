// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/induction_machine/induction_equations.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// The machines of 3 and 500 hp of table 4.10-1 in Krause, Wasynczuk and Sudhoff, Analysis of Electric Machinery, 2nd
/// ed. 2002: ohms and kg m2 there, p.u. on their rated power here.
namespace gridspace::sim {
namespace {

constexpr double kOmega = 2 * std::numbers::pi * 60;
TimeBase const kBase{Rational{1, 48000}};

struct Nameplate {
    double kva, volts, rs, xs, xm, xr, rr, inertia; ///< ohms, kg m2
    int poles{4};
    [[nodiscard]] double z() const { return volts * volts / (kva * 1e3); }
    [[nodiscard]] double torque_nm() const { return kva * 1e3 / (kOmega * 2 / poles); }
    [[nodiscard]] double h_s() const { return 0.5 * inertia * std::pow(kOmega * 2 / poles, 2) / (kva * 1e3); }
};
constexpr double kHorsepowerKw = 0.7457;
Nameplate const kSmall{3 * kHorsepowerKw, 220, 0.435, 0.754, 26.13, 0.754, 0.816, 0.089};
Nameplate const kLarge{500 * kHorsepowerKw, 2300, 0.262, 1.206, 54.02, 1.206, 0.187, 11.06};

std::string constants(Nameplate const& n) {
    return fmt::format("{{rs: {}, xs: {}, xm: {}, rr: {}, xr: {}}}", n.rs / n.z(), n.xs / n.z(), n.xm / n.z(),
                       n.rr / n.z(), n.xr / n.z());
}

/// Behind `impedance` ("r_ohm: .., l_mh: .."; nothing: an ideal voltage) of a source.
config::Diagnostics read(std::string const& machine, double volts, std::string const& impedance, Network& out,
                         std::string const& more = "") {
    std::string const text = fmt::format("gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
                                         "buses: {{A: {{voltage_v: {}}}}}\nsources: {{S: {{bus: A{}}}}}\n{}"
                                         "induction_machines: {{M: {{bus: A, {}}}}}\n",
                                         volts, impedance, more, machine);
    return read_text(text, out);
}

Network network(std::string const& machine, double volts, std::string const& impedance = "",
                std::string const& more = "") {
    Network n;
    config::Diagnostics const diagnostics = read(machine, volts, impedance, n, more);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

std::string machine(Nameplate const& n, double load_pu, std::string const& more = "") {
    return fmt::format("rating_kva: {}, load_kw: {}, inertia_h_s: {}, constants_pu: {}{}", n.kva, load_pu * n.kva,
                       n.h_s(), constants(n), more);
}

std::unique_ptr<Engine> started(std::string const& solver, Network const& n) {
    auto sut = make(solver, n, kBase);
    must(sut->initialise());
    return sut;
}

void advance(Engine& sut, double to_s) {
    must(sut.advance(SimTime{} + SimSpan{std::llround(to_s * 48000)}));
}

/// Krause's equations in ohms, webers and newton metres, in the standing frame of the stator, by Runge-Kutta: another
/// form than the machine's own (fluxes of stator and rotor as states, the air gap's flux eliminated). No load, no
/// damping.
struct Oracle {
    Nameplate n;
    std::array<double, 5> x{}; ///< psi_alpha, psi_beta of stator and rotor (V), electrical speed (rad/s)

    [[nodiscard]] std::array<double, 4> currents(std::array<double, 5> const& at) const {
        double const ss = n.xs + n.xm, rr = n.xr + n.xm, d = ss * rr - n.xm * n.xm;
        return {(rr * at[0] - n.xm * at[2]) / d, (rr * at[1] - n.xm * at[3]) / d, (ss * at[2] - n.xm * at[0]) / d,
                (ss * at[3] - n.xm * at[1]) / d};
    }
    [[nodiscard]] double torque_nm(std::array<double, 5> const& at) const {
        auto const i = currents(at);
        return 1.5 * n.poles / 2 / kOmega * (at[0] * i[1] - at[1] * i[0]);
    }
    [[nodiscard]] std::array<double, 5> slope(std::array<double, 5> const& at, double t) const {
        double const peak = n.volts * std::sqrt(2.0 / 3);
        auto const i = currents(at);
        return {kOmega * (peak * std::cos(kOmega * t) - n.rs * i[0]),
                kOmega * (peak * std::sin(kOmega * t) - n.rs * i[1]), -kOmega * n.rr * i[2] - at[4] * at[3],
                -kOmega * n.rr * i[3] + at[4] * at[2], n.poles / 2.0 / n.inertia * torque_nm(at)};
    }
    void advance(double from_s, double to_s, double h) {
        auto const add = [](std::array<double, 5> a, std::array<double, 5> const& b, double k) {
            for (std::size_t s = 0; s < a.size(); ++s) {
                a[s] += k * b[s];
            }
            return a;
        };
        long const steps = std::lround((to_s - from_s) / h);
        for (long k = 0; k < steps; ++k) {
            double const t = from_s + static_cast<double>(k) * h;
            auto const a = slope(x, t), b = slope(add(x, a, h / 2), t + h / 2), c = slope(add(x, b, h / 2), t + h / 2),
                       d = slope(add(x, c, h), t + h);
            x = add(add(add(add(x, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
        }
    }
};

class FreeAcceleration : public testing::TestWithParam<Nameplate const*> {};
INSTANTIATE_TEST_SUITE_P(Machine, FreeAcceleration, testing::Values(&kSmall, &kLarge));

TEST_P(FreeAcceleration, FollowsKrausesEquationsInWaveforms) {
    Nameplate const& n = *GetParam();
    auto const sut = started("emt", network(machine(n, 0, ", state: stopped"), n.volts));
    EXPECT_EQ(read(*sut, "induction_machine.M.speed_pu"), 0);
    must(sut->apply(SwitchBreaker{"M", true}));
    Oracle oracle{n};
    double t = 0, peak_a = 0;
    double const base_a = n.kva * 1e3 / n.volts * std::sqrt(2.0 / 3);
    for (double const to : {0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0}) {
        oracle.advance(t, to, 1 / 96000.0);
        advance(*sut, to);
        t = to;
        EXPECT_NEAR(read(*sut, "induction_machine.M.speed_pu"), oracle.x[4] / kOmega, 1e-3) << to;
        EXPECT_NEAR(read(*sut, "induction_machine.M.torque_pu"), oracle.torque_nm(oracle.x) / n.torque_nm(), 0.02)
            << to;
        EXPECT_NEAR(read(*sut, "induction_machine.M.i.a") / base_a, oracle.currents(oracle.x)[0] / base_a, 0.02) << to;
        peak_a = std::max(peak_a, std::abs(oracle.currents(oracle.x)[0]) / base_a);
    }
    EXPECT_GT(peak_a, 3) << "it did draw the current of a start";
}

/// Thevenin's form of the torque at slip s, p.u. [Krause 4.9; any textbook].
double torque_at(Nameplate const& n, double s) {
    Complex const xm{0, n.xm}, own{n.rs, n.xs}, th = xm * own / (own + xm);
    double const e = n.volts * std::abs(xm / (own + xm)); // line to line: three phases together
    double const r = n.rr / s, x = th.imag() + n.xr;
    return e * e * r / (std::pow(th.real() + r, 2) + x * x) / (n.kva * 1e3);
}

TEST(InductionMachine, TorqueOverSlipIsThatOfTheEquivalentCircuit) {
    for (Nameplate const* n : {&kSmall, &kLarge}) {
        induction::Machine const sut{network(machine(*n, 0), n->volts).induction_machines[0]};
        for (double const s : {0.001, 0.01, 0.05, 0.2, 0.5, 1.0, 1.8, -0.02}) {
            EXPECT_NEAR(sut.torque(s, 1), torque_at(*n, s), 1e-12 + 1e-9 * std::abs(torque_at(*n, s))) << s;
        }
    }
}

class InductionMachineIn : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Solver, InductionMachineIn, testing::Values("phasor", "emt"));

TEST_P(InductionMachineIn, StartsSettledWhereThePowerFlowFoundIt) {
    Network const n = network(machine(kLarge, 0.8), 2300, ", r_ohm: 0.2, l_mh: 2");
    auto const flow = solve_power_flow(n, SwitchState{n});
    ASSERT_TRUE(flow.has_value());
    auto const sut = started(GetParam(), n);
    double const speed = read(*sut, "induction_machine.M.speed_pu");
    EXPECT_NEAR(read(*sut, "induction_machine.M.torque_pu"), 0.8 * speed * speed, 1e-4);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), std::abs(flow->buses[0].v), 2e-5);
    double const p = read(*sut, "induction_machine.M.p_kw");
    // What is drawn: the load's power, and the heat of rotor and stator.
    EXPECT_NEAR(p - kLarge.rs / kLarge.z() * std::pow(read(*sut, "induction_machine.M.current_pu"), 2) * kLarge.kva,
                0.8 * speed * speed * kLarge.kva, 0.05);
    for (double const to : {0.02, 0.3, 1.0}) {
        advance(*sut, to);
        EXPECT_NEAR(read(*sut, "induction_machine.M.speed_pu"), speed, 2e-6) << to;
        EXPECT_NEAR(read(*sut, "induction_machine.M.p_kw"), p, 0.02) << to;
    }
}

TEST_P(InductionMachineIn, ComesBackAfterAShortDipAndStallsAfterALongOne) {
    for (bool const lasts : {false, true}) {
        auto const sut =
            started(GetParam(), network(machine(kLarge, 0.9, ", load_exponent: 0"), 2300, ", r_ohm: 0.2, l_mh: 2"));
        advance(*sut, 0.1);
        must(sut->apply(SetParameter{"sources.S.voltage_pu", 0.3}));
        advance(*sut, lasts ? 1.6 : 0.2);
        must(sut->apply(SetParameter{"sources.S.voltage_pu", 1}));
        advance(*sut, 6);
        double const speed = read(*sut, "induction_machine.M.speed_pu");
        if (lasts) {
            EXPECT_LT(speed, 0.3) << "it has stopped";
            EXPECT_GT(read(*sut, "induction_machine.M.current_pu"), 3) << "and draws the current of a start";
        } else {
            EXPECT_GT(speed, 0.97);
        }
    }
}

TEST_P(InductionMachineIn, DrivenAboveSynchronousSpeedItFeedsTheGrid) {
    auto const sut = started(GetParam(), network(machine(kLarge, -0.7, ", load_exponent: 0"), 2300));
    EXPECT_GT(read(*sut, "induction_machine.M.speed_pu"), 1);
    EXPECT_NEAR(read(*sut, "induction_machine.M.torque_pu"), -0.7, 1e-5);
    EXPECT_LT(read(*sut, "induction_machine.M.p_kw"), -0.6 * kLarge.kva);
    EXPECT_GT(read(*sut, "induction_machine.M.q_kvar"), 0) << "it is still magnetised from the grid";
}

TEST_P(InductionMachineIn, IsSwitchedOffAndComesToRest) {
    auto const sut = started(GetParam(), network(machine(kSmall, 0.8, ", load_exponent: 0"), 220, ", r_ohm: 0.1"));
    must(sut->apply(SwitchBreaker{"M", false}));
    double const before = read(*sut, "induction_machine.M.speed_pu");
    advance(*sut, 0.3); // w' = - load / 2 H, once the current has ended
    EXPECT_NEAR(read(*sut, "induction_machine.M.speed_pu"), before - 0.8 * 0.3 / (2 * kSmall.h_s()), 0.02);
    advance(*sut, 4);
    EXPECT_NEAR(read(*sut, "induction_machine.M.speed_pu"), 0, 1e-3) << "a load that is driven does not turn back";
    EXPECT_NEAR(read(*sut, "induction_machine.M.p_kw"), 0, 1e-4);
    EXPECT_NEAR(read(*sut, "bus.A.v_pu"), 1, 1e-5);
}

TEST(InductionMachine, BothSolversStartItUnderLoadInTheSameTime) {
    std::array<double, 2> seconds{};
    for (std::size_t k = 0; k < 2; ++k) {
        auto const sut = started(k == 0 ? "emt" : "phasor",
                                 network(machine(kLarge, 0.5, ", state: stopped"), 2300, ", r_ohm: 0.1, l_mh: 1"));
        must(sut->apply(SwitchBreaker{"M", true}));
        while (read(*sut, "induction_machine.M.speed_pu") < 0.95 && seconds[k] < 10) {
            advance(*sut, seconds[k] += 0.01);
        }
    }
    EXPECT_NEAR(seconds[0], seconds[1], 0.05 * seconds[0])
        << "stator transients, which phasors leave out, slow it a little";
    EXPECT_GT(seconds[0], 0.5);
}

TEST(InductionMachine, ASecondCageRaisesTheTorqueAtStandstill) {
    std::string const one = "rs: 0.02, xs: 0.1, xm: 3.5, rr: 0.02, xr: 0.15";
    auto const torque = [&](std::string const& cages) {
        return induction::Machine{
            network("rating_kva: 100, load_kw: 50, inertia_h_s: 0.5, constants_pu: {" + cages + "}", 400)
                .induction_machines[0]}
            .torque(1, 1);
    };
    EXPECT_GT(torque(one + ", rr2: 0.15, xr2: 0.05"), 2 * torque(one));
    // Cages that are alike are one with half their impedance.
    EXPECT_NEAR(torque("rs: 0.02, xs: 0.1, xm: 3.5, rr: 0.04, xr: 0.3, rr2: 0.04, xr2: 0.3"), torque(one), 1e-12);
}

TEST(InductionMachine, ALoadThatItCannotCarryIsAnErrorOfTheFileAndOfTheStart) {
    Network n;
    auto const diagnostics = read(machine(kLarge, 3.5, ", load_exponent: 0"), 2300, "", n);
    EXPECT_EQ(diagnostics.errors(), 1);
    EXPECT_NE(diagnostics.render().find("'M' cannot carry"), std::string::npos) << diagnostics.render();
    // At its nominal voltage it could, but not behind this source.
    for (char const* solver : {"phasor", "emt"}) {
        auto const weak =
            make(solver, network(machine(kLarge, 2, ", load_exponent: 0"), 2300, ", r_ohm: 0.2, l_mh: 8"), kBase);
        auto const done = weak->initialise();
        ASSERT_FALSE(done.has_value()) << solver;
        EXPECT_NE(describe(done.error()).find("'M'"), std::string::npos) << describe(done.error());
    }
}

TEST(InductionMachine, RunsOnInAnUnbalancedNetworkAndItsTorquePulses) {
    auto const sut = make("emt",
                          network(machine(kSmall, 0.5), 220, ", r_ohm: 0.5, l_mh: 1",
                                  "loads: {L: {bus: A, phase_p_kw: [1, 0, 0], phase_q_kvar: [0, 0, 0]}}\n"),
                          kBase);
    must(sut->initialise());
    double const speed = read(*sut, "induction_machine.M.speed_pu");
    double low = 1e9, high = -1e9;
    for (int k = 1; k <= 480; ++k) { // ten periods
        must(sut->advance(SimTime{} + SimSpan{k * 20}));
        low = std::min(low, read(*sut, "induction_machine.M.torque_pu"));
        high = std::max(high, read(*sut, "induction_machine.M.torque_pu"));
    }
    EXPECT_NEAR(read(*sut, "induction_machine.M.speed_pu"), speed, 1e-3);
    EXPECT_GT(high - low, 1e-3);
}

} // namespace
} // namespace gridspace::sim
