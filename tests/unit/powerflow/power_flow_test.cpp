// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/power_flow.hpp"

#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "sim/network/network_config.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

Network network_of(std::string_view body) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n" + std::string{body};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return std::move(*network);
}

PowerFlow solved(Network const& network, PowerFlowOptions const& options = {}) {
    auto result = solve_power_flow(network, SwitchState{network}, options);
    EXPECT_TRUE(result.has_value()) << (result ? "" : describe(result.error()));
    return result.value_or(PowerFlow{});
}

/// What the element of that name at one bus gives.
PowerFlow::UnitValue unit(Network const& n, PowerFlow const& flow, std::string_view name) {
    auto const elements = one_ports(n);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        if (elements[i]->name.name == name) {
            return flow.units[i];
        }
    }
    ADD_FAILURE() << "no element " << name;
    return {};
}

constexpr std::string_view kTwoBuses = "buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                                       "lines: {L: {from: A, to: B, r_ohm: 0.2304, x_ohm: 0.4608}}\n" // 0.1 + j0.2 p.u.
                                       "generators: {G: {bus: A, role: slack}}\n";

TEST(PowerFlow, TwoBusesHaveTheAnalyticVoltage) {
    // |V|^2 solves V^4 + (2(RP + XQ) - E^2) V^2 + (R^2 + X^2)(P^2 + Q^2) = 0.
    Network const n = network_of(std::string{kTwoBuses} + "loads: {D: {bus: B, p_kw: 50, q_kvar: 20}}\n");
    PowerFlow const sut = solved(n);
    double const b = 2 * (0.1 * 0.5 + 0.2 * 0.2) - 1, c = (0.01 + 0.04) * (0.25 + 0.04);
    double const expected = std::sqrt((-b + std::sqrt(b * b - 4 * c)) / 2);
    EXPECT_NEAR(std::abs(sut.buses[1].v), expected, 1e-12);
    EXPECT_NEAR(sut.buses[1].p_kw, -50, 1e-7);
    EXPECT_NEAR(unit(n, sut, "G").p_kw, 50 + sut.losses_kw, 1e-7);
    double const current_squared = 0.29 / (expected * expected);
    EXPECT_NEAR(sut.losses_kw, 100 * 0.1 * current_squared, 1e-7);
}

TEST(PowerFlow, PowerIsConservedWithEveryKindOfLoad) {
    Network const n =
        network_of(std::string{kTwoBuses} +
                   "loads:\n"
                   "  P: {bus: B, p_kw: 10, power_factor: 0.9}\n"
                   "  I: {bus: B, p_kw: 10, power_factor: 0.9, model: constant_current}\n"
                   "  Z: {bus: B, p_kw: 10, power_factor: 0.9, model: constant_impedance}\n"
                   "  E: {bus: B, p_kw: 10, power_factor: 0.9, model: exponential, exponent_p: 1.3, exponent_q: 2}\n"
                   "  M: {bus: B, p_kw: 10, model: zip, zip_p: [0.2, 0.3, 0.5]}\n"
                   "shunts: {C: {bus: B, q_kvar: 5}}\n"
                   "pv: {S: {bus: B, p_kw: 20, rating_kva: 20}}\n");
    PowerFlow const sut = solved(n);
    double injected = 0;
    for (auto const& bus : sut.buses) {
        injected += bus.p_kw;
    }
    EXPECT_NEAR(injected, sut.losses_kw, 1e-7);
    EXPECT_LT(sut.iterations, 7);
}

TEST(PowerFlow, TheTapRaisesTheSecondarySide) {
    Network const n = network_of("buses: {A: {voltage_v: 11000}, B: {voltage_v: 480}}\n"
                                 "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 5, tap_ratio: 0.95}}\n"
                                 "generators: {G: {bus: A, role: slack}}\n");
    EXPECT_NEAR(std::abs(solved(n).buses[1].v), 1 / 0.95, 1e-12);
}

TEST(PowerFlow, APhaseShifterLetsTheSecondarySideLag) {
    Network const n =
        network_of("buses: {A: {voltage_v: 11000}, B: {voltage_v: 480}}\n"
                   "transformers: {T: {from: A, to: B, rating_kva: 100, x_percent: 5, phase_shift_deg: 30}}\n"
                   "generators: {G: {bus: A, role: slack}}\n");
    EXPECT_NEAR(std::arg(solved(n).buses[1].v), -std::numbers::pi / 6, 1e-9);
}

TEST(PowerFlow, AnyAngleOfTheSourceAndAnyChainOfShiftsGivesTheSameMagnitudes) {
    auto const chain = [](double source_deg, double shift_deg) {
        return network_of(fmt::format(
            "buses: {{A: {{voltage_v: 110000}}, B: {{voltage_v: 20000}}, C: {{voltage_v: 10000}}, D: {{voltage_v: "
            "400}}}}\n"
            "generators: {{G: {{bus: A, role: slack, angle_deg: {0}}}}}\n"
            "transformers:\n"
            "  AB: {{from: A, to: B, rating_kva: 25000, r_percent: 0.5, x_percent: 11, phase_shift_deg: {1}}}\n"
            "  BC: {{from: B, to: C, rating_kva: 5000, r_percent: 0.6, x_percent: 7, phase_shift_deg: {1}}}\n"
            "  DC: {{from: D, to: C, rating_kva: 630, r_percent: 1, x_percent: 6, phase_shift_deg: {2}}}\n" // backwards
            "loads: {{L: {{bus: D, p_kw: 300, power_factor: 0.95}}}}\n",
            source_deg, shift_deg, -shift_deg));
    };
    PowerFlow const flat = solved(chain(0, 0));
    for (double const source : {0.0, 60.0, 120.0, 180.0, -90.0}) {
        for (double const shift : {0.0, 30.0, -30.0, 150.0, 180.0}) {
            PowerFlow const sut = solved(chain(source, shift));
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_NEAR(std::abs(sut.buses[i].v), std::abs(flat.buses[i].v), 1e-9) << source << ' ' << shift;
            }
            double const turned = std::arg(sut.buses[3].v / flat.buses[3].v) * 180 / std::numbers::pi;
            EXPECT_NEAR(std::remainder(turned - source + 3 * shift, 360), 0, 1e-6) << source << ' ' << shift;
        }
    }
}

TEST(PowerFlow, AnIslandWithoutASourceHangsOnItsLargestMachine) {
    Network const n = network_of(
        "buses: {A: {voltage_v: 208}, B: {voltage_v: 208}}\n"
        "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\n"
        "machine_types: {t: {constants_pu: {xd: 1.3, xq: 0.5, xd1: 0.3, xd2: 0.25, xq2: 0.25, xl: 0.18}, "
        "times_s: {td01: 4, td02: 0.06, tq02: 0.1}, inertia_h_s: 2}}\n"
        "machines: {G1: {bus: A, type: t, rating_kva: 10, p_kw: 1}, G2: {bus: B, type: t, rating_kva: 20, p_kw: 1}}\n"
        "loads: {D: {bus: A, p_kw: 5}}\n");
    PowerFlow const sut = solved(n);
    EXPECT_NEAR(unit(n, sut, "G1").p_kw, 1, 1e-9);
    EXPECT_NEAR(unit(n, sut, "G2").p_kw, 4 + sut.losses_kw, 1e-7);
}

TEST(PowerFlow, ASourceBehindAnImpedanceDeliversWhatTheNetworkTakes) {
    config::Diagnostics diagnostics;
    auto const n = load_network(source_tree("configs/networks/adn_set_a.yaml"), diagnostics);
    ASSERT_TRUE(n.has_value()) << diagnostics.render();
    PowerFlow const sut = solved(*n);
    // physics.md of the design: about 0.973 p.u. at B3 and B4, 12.66 A in TL-2, before the fault.
    EXPECT_NEAR(std::abs(sut.buses[index_of(n->buses, "B3")].v), 0.973, 0.001);
    EXPECT_NEAR(std::abs(sut.buses[index_of(n->buses, "B4")].v), 0.973, 0.001);
    double loads_kw = 0;
    for (auto const& load : n->loads) {
        loads_kw += load.p_kw * std::norm(sut.buses[index_of(n->buses, load.bus.name)].v);
    }
    EXPECT_NEAR(unit(*n, sut, n->sources.front().name.name).p_kw + 8.0, loads_kw + sut.losses_kw, 1e-6);
}

TEST(PowerFlow, ReactiveLimitsReleaseTheVoltage) {
    std::string_view const body =
        "buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
        "lines: {L: {from: A, to: B, r_ohm: 0.02, x_ohm: 0.4608}}\n"
        "generators:\n  G: {bus: A, role: slack}\n"
        "  V: {bus: B, role: pv, p_kw: 10, voltage_setpoint_pu: 1.05, q_max_kvar: 5, q_min_kvar: -5}\n"
        "loads: {D: {bus: B, p_kw: 40, q_kvar: 30}}\n";
    Network const n = network_of(body);
    PowerFlowOptions limited;
    limited.enforce_q_limits = true;
    EXPECT_NEAR(std::abs(solved(n).buses[1].v), 1.05, 1e-12);
    PowerFlow const sut = solved(n, limited);
    EXPECT_LT(std::abs(sut.buses[1].v), 1.0);
    EXPECT_NEAR(sut.buses[1].q_kvar, 5 - 30, 1e-6);
}

TEST(PowerFlow, AReactiveLimitIsThatOfTheGeneratorAndNotOfWhatElseInjectsAtItsBus) {
    Network const n = network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                                 "lines: {L: {from: A, to: B, r_ohm: 0.02, x_ohm: 0.4608}}\n"
                                 "generators:\n  G: {bus: A, role: slack}\n"
                                 "  V: {bus: B, role: pv, p_kw: 10, voltage_setpoint_pu: 1, q_max_kvar: 20}\n"
                                 "  P: {bus: B, role: pq, p_kw: 0, q_kvar: 10}\n"
                                 "loads: {D: {bus: B, p_kw: 10, q_kvar: 25}, E: {bus: B, p_kw: 0, q_kvar: 25}}\n");
    PowerFlowOptions limited;
    limited.enforce_q_limits = true;
    PowerFlow const beyond = solved(n, limited);
    EXPECT_LT(std::abs(beyond.buses[1].v), 1.0);
    EXPECT_NEAR(beyond.buses[1].q_kvar, 20 + 10 - 50, 1e-6);
    EXPECT_NEAR(unit(n, beyond, "V").q_kvar, 20, 1e-6);
    // Without one load it gives 15 kvar: within its limit, although both together give more than that.
    Network less = n;
    less.loads.pop_back();
    PowerFlow const within = solved(less, limited);
    EXPECT_NEAR(std::abs(within.buses[1].v), 1, 1e-12);
    EXPECT_NEAR(unit(less, within, "V").q_kvar, 15, 1e-6);
}

TEST(PowerFlow, ALineOpenAtOneEndOnlyDrawsItsChargingCurrent) {
    Network const n = network_of("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                                 "lines:\n  L1: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}\n"
                                 "  L2: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2, c_nf: 1000000}\n"
                                 "breaker_types: {t: {}}\nbreakers: {CB: {line: L2, end: to, type: t, state: open}}\n"
                                 "generators: {G: {bus: A, role: slack}}\n");
    PowerFlow const sut = solved(n);
    EXPECT_EQ(sut.branches[1].p_to_kw, 0);
    EXPECT_NEAR(sut.branches[1].q_from_kvar, -480.0 * 480.0 * 2 * std::numbers::pi * 60 * 1e-3 / 1e3, 2.5);
}

TEST(PowerFlow, AnOverloadedNetworkSaysWhichBusAndWhy) {
    Network const n = network_of(std::string{kTwoBuses} + "loads: {D: {bus: B, p_kw: 500, q_kvar: 200}}\n");
    auto const sut = solve_power_flow(n, SwitchState{n});
    ASSERT_FALSE(sut.has_value());
    EXPECT_THAT(sut.error().message, ::testing::HasSubstr("bus 'B'"));
    EXPECT_THAT(sut.error().remedy, ::testing::HasSubstr("it has a solution up to"));
}

} // namespace
} // namespace gridspace::sim
