// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The waveforms of a large network have the same bits, however many threads step it.
#include "tests/unit/emt/emt_fixture.hpp"

#include "common/team.hpp"
#include "sim/emt/network_circuit.hpp"
#include "sim/emt/solver.hpp"

#include <bit>
#include <cstdint>
#include <fmt/format.h>
#include <numeric>

namespace gridspace::sim::emt {
namespace {

TimeBase const kBase{Rational{1, 48000}};
constexpr int kSide = 8;

/// Buses of a square with a line to the right and one down of each, and a load of constant power.
std::string square(char name) {
    std::string buses, lines, loads;
    for (int i = 0; i < kSide * kSide; ++i) {
        buses += fmt::format("  {}{}: {{voltage_v: 12470}}\n", name, i);
        loads +=
            fmt::format("  D{0}{1}: {{bus: {0}{1}, p_kw: 20, power_factor: 0.95, model: constant_power}}\n", name, i);
        for (int const to : {i % kSide + 1 < kSide ? i + 1 : -1, i / kSide + 1 < kSide ? i + kSide : -1}) {
            if (to >= 0) {
                lines += fmt::format(
                    "  L{0}{1}_{2}: {{from: {0}{1}, to: {0}{2}, r_ohm: 0.1, l_mh: 0.6, c_nf: 20, r0_ohm: 0.3, "
                    "l0_mh: 1.8}}\n",
                    name, i, to);
            }
        }
    }
    return buses + "|" + lines + "|" + loads;
}

/// Two squares with waves between them, one of a frequency-dependent line. `balanced`: with machines, converters, a
/// core that saturates, breakers; otherwise with loads by phase.
Network two_squares(bool balanced) {
    std::array<std::string, 3> parts;
    for (char const name : {'A', 'B'}) {
        std::string const all = square(name);
        std::size_t const first = all.find('|'), second = all.rfind('|');
        parts[0] += all.substr(0, first);
        parts[1] += all.substr(first + 1, second - first - 1);
        parts[2] += all.substr(second + 1);
    }
    std::string text = "buses:\n" + parts[0];
    std::string const lines =
        parts[1] +
        "  W: {from: A63, to: B0, r_ohm: 1, l_mh: 25, c_nf: 280, r0_ohm: 3, l0_mh: 60, c0_nf: 150, model: bergeron}\n"
        "  F: {from: A56, to: B7, type: overhead, length_km: 30, model: frequency_dependent, fault_places_percent: "
        "[50]}\n"
        "line_types: {overhead: {conductors: [{phase: a, x_m: -1, height_m: 10, radius_m: 0.006, dc_ohm_per_km: 0.3}, "
        "{phase: b, x_m: 0, height_m: 11, radius_m: 0.006, dc_ohm_per_km: 0.3}, "
        "{phase: c, x_m: 1, height_m: 10, radius_m: 0.006, dc_ohm_per_km: 0.3}]}}\n";
    if (!balanced) {
        return network_of(
            text + "sources: {S: {bus: A0, r_ohm: 0.05, l_mh: 0.5}}\nlines:\n" + lines + "loads:\n" + parts[2] +
                "  P: {bus: B9, phase_p_kw: [20, 30, 40], phase_q_kvar: [5, 5, 9], model: constant_power}\n",
            1000);
    }
    text +=
        "  T: {voltage_v: 400}\nsources: {S: {bus: A0, r_ohm: 0.05, l_mh: 0.5, harmonics: [{order: 5, percent: "
        "1}]}}\nlines:\n" +
        lines + "loads:\n" + parts[2] +
        "  DT: {bus: T, p_kw: 20, power_factor: 0.9, model: constant_impedance}\n"
        "transformers: {X: {from: B20, to: T, rating_kva: 100, x_percent: 4, magnetising_percent: 1, "
        "saturation: {knee_pu: 1.05, air_core_percent: 30}}}\n"
        "machine_types:\n"
        "  round: {constants_pu: {xd: 1.8, xq: 1.7, xd1: 0.3, xd2: 0.23, xq2: 0.23, xl: 0.15, x0: 0.12, ra: 0.003}, "
        "times_s: {td01: 8, td02: 0.03, tq02: 0.07}, inertia_h_s: 3, avr: {ka: 50, ta_s: 0.02, tr_s: 0.02, efd_min_pu: "
        "-6, "
        "efd_max_pu: 8}, governor: {droop_percent: 5, tg_s: 0.1, tt_s: 0.5}}\n"
        "  salient: {constants_pu: {xd: 1.3, xq: 0.5, xd1: 0.3, xd2: 0.25, xq2: 0.2, xl: 0.15, x0: 0.1, ra: 0.006}, "
        "times_s: {td01: 4.5, td02: 0.06, tq02: 0.1}, inertia_h_s: 2}\n"
        "machines:\n"
        "  G1: {bus: A27, type: round, rating_kva: 500, p_kw: 200, voltage_setpoint_pu: 1}\n"
        "  G2: {bus: B36, type: salient, rating_kva: 700, p_kw: 300, voltage_setpoint_pu: 1}\n"
        "pv: {P1: {bus: A50, p_kw: 90}, P2: {bus: B50, p_kw: 90}}\n"
        "batteries: {X1: {bus: B41, capacity_kwh: 10, rating_kva: 80, p_kw: -40}}\n"
        "breaker_types: {b: {mechanism_ms: 1, opens: each_pole_at_current_zero}}\n"
        "breakers: {K: {line: LB8_9, end: from, type: b}}\n";
    return network_of(text, 1000);
}

struct Change {
    int step;
    Action action;
};

/// Bits of everything that can be read, after every tenth step: a checksum of each signal's values.
std::vector<std::uint64_t> bits(Network network, int steps, std::vector<Change> const& changes,
                                std::shared_ptr<Team> team) {
    auto engine = make_emt_engine(std::move(network), {kBase, SimSpan{1}, 0, std::move(team)});
    EXPECT_TRUE(engine.has_value()) << (engine ? "" : describe(engine.error()));
    auto const ok = (*engine)->initialise();
    EXPECT_TRUE(ok.has_value()) << (ok ? "" : describe(ok.error()));
    std::vector<std::uint64_t> out((*engine)->signals().size(), 0);
    for (int n = 1; n <= steps; ++n) {
        advance(**engine, SimTime{n});
        for (std::size_t i = 0; n % 10 == 0 && i < out.size(); ++i) {
            out[i] = out[i] * 1099511628211ULL + std::bit_cast<std::uint64_t>((*engine)->value(i));
        }
        for (Change const& change : changes) {
            if (change.step == n) {
                apply(**engine, change.action);
            }
        }
    }
    return out;
}

std::vector<Change> switching() {
    return {{20, ApplyFault{"LA27_28", "", 30, FaultType::phase_phase_ground, 0.5, "f"}},
            {200, ClearFault{"f"}},
            {300, SwitchBreaker{"K", false}},
            {500, ApplyFault{"", "B36", 0, FaultType::three_phase_ground, 0.1, "g"}},
            {600, ClearFault{"g"}},
            {750, SwitchBreaker{"K", true}},
            {800, SetParameter{"loads.DA9.p_kw", 400}},
            {850, Disconnect{"LB1_2"}},
            {900, ApplyFault{"W", "", 50, FaultType::phase_ground, 1, "w"}},
            {950, ApplyFault{"F", "", 50, FaultType::phase_ground, 1, "fd"}}};
}

TEST(EmtThreads, GiveTheSameBitsWithFaultsSwitchingMachinesAndCores) {
    Network const network = two_squares(true);
    auto const expected = bits(network, 1000, switching(), nullptr);
    EXPECT_NE(std::accumulate(expected.begin(), expected.end(), std::uint64_t{0}), 0U);
    for (int const threads : {1, 2, 3, 7}) {
        EXPECT_EQ(bits(network, 1000, switching(), make_thread_team(threads)), expected) << threads;
    }
}

TEST(EmtThreads, GiveTheSameBitsWithLoadsByPhase) {
    Network const network = two_squares(false);
    std::vector<Change> const fault{{20, ApplyFault{"", "A20", 0, FaultType::phase_ground, 1, "f"}},
                                    {200, ClearFault{"f"}}};
    auto const expected = bits(network, 400, fault, nullptr);
    for (int const threads : {2, 3}) {
        EXPECT_EQ(bits(network, 400, fault, make_thread_team(threads)), expected) << threads;
    }
}

TEST(EmtThreads, ADifferenceWouldBeSeen) { // negative control
    Network const network = two_squares(true);
    EXPECT_NE(bits(network, 30, {{20, SetParameter{"loads.DB63.p_kw", 20.0000001}}}, make_thread_team(2)),
              bits(network, 30, {}, nullptr));
}

TEST(EmtThreads, StepPartsOfALargeNetworkAndLeaveASmallOneInOne) {
    auto const parts = [](Network const& network, int threads) {
        auto circuit = make_circuit(network, 0);
        EXPECT_TRUE(circuit.has_value());
        std::size_t const norton = circuit->circuit.norton.size(), injections = circuit->circuit.injections.size();
        Solver sut{std::move(circuit->circuit), 1.0 / 48000, make_thread_team(threads)};
        EXPECT_TRUE(sut.start(std::vector<Solver::NortonStart>(norton),
                              std::vector<std::array<std::complex<double>, 3>>(injections))
                        .has_value());
        return sut.parts();
    };
    EXPECT_EQ(parts(two_squares(true), 1), 1U);
    EXPECT_EQ(parts(two_squares(true), 2), 2U);
    EXPECT_EQ(parts(two_squares(false), 2), 2U);
    EXPECT_EQ(parts(shipped_network("wscc9.yaml"), 2), 1U);
}

} // namespace
} // namespace gridspace::sim::emt
