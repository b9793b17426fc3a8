// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A step of the whole waveform engine allocates nothing, with every kind of element in it. A program of its own: it
// counts allocations.
#include "tests/support/allocations.hpp"
#include "tests/unit/emt/emt_fixture.hpp"

#include "common/team.hpp"

#include <fmt/format.h>

namespace gridspace::sim::emt {
namespace {

TimeBase const kBase{Rational{1, 48000}};

/// Allocations of a thousand steps and of reading everything after each tenth.
std::size_t allocations_of_steps(Network network, std::shared_ptr<Team> team = nullptr) {
    auto const sut = started(std::move(network), kBase, Rational{1, 48000}, std::move(team));
    std::size_t const signals = sut->signals().size();
    double sum = 0;
    bool fine = true;
    auto const run = [&](int from, int to) {
        for (int n = from + 1; n <= to; ++n) {
            fine = sut->advance(SimTime{n}).has_value() && fine;
            for (std::size_t i = 0; n % 10 == 0 && i < signals; ++i) {
                sum += sut->value(i);
            }
        }
    };
    run(0, 100);
    std::size_t const before = allocations();
    run(100, 1100);
    std::size_t const counted = allocations() - before;
    EXPECT_TRUE(fine);
    EXPECT_NE(sum, 0);
    return counted;
}

TEST(EmtEngineStep, AllocatesNothingWithMachinesAndInstruments) {
    EXPECT_EQ(allocations_of_steps(shipped_network("adn_set_a.yaml")), 0U);
    EXPECT_EQ(allocations_of_steps(shipped_network("wscc9.yaml")), 0U);
}

TEST(EmtEngineStep, AllocatesNothingWithConvertersWavesCoresAndFilters) {
    EXPECT_EQ(
        allocations_of_steps(network_of(
            "buses: {A: {voltage_v: 20000}, B: {voltage_v: 20000}, C: {voltage_v: 400}, D: {voltage_v: 20000}}\n"
            "sources: {S: {bus: A, r_ohm: 0.1, l_mh: 1, harmonics: [{order: 5, percent: 1}]}}\n"
            "line_types: {t: {conductors: [{phase: a, x_m: -1, height_m: 9, radius_m: 0.006, dc_ohm_per_km: 0.3}, "
            "{phase: b, "
            "x_m: 0, height_m: 9, radius_m: 0.006, dc_ohm_per_km: 0.3}, {phase: c, x_m: 1, height_m: 9, radius_m: "
            "0.006, "
            "dc_ohm_per_km: 0.3}]}}\n"
            "lines: {L: {from: A, to: B, r_ohm: 1, l_mh: 20, c_nf: 300, model: bergeron}, "
            "M: {from: A, to: D, type: t, length_km: 20, model: frequency_dependent}}\n"
            "transformers: {T: {from: B, to: C, rating_kva: 400, x_percent: 4, magnetising_percent: 1, "
            "saturation: {knee_pu: 1.3, air_core_percent: 30}}}\n"
            "ct_types: {c: {filter: butterworth2, cutoff_hz: 2000, quantum_ma: 1, saturation: {knee_v: 100, "
            "magnetising_ma: 50, winding_ohm: 1, burden_ohm: 1, air_core_mh: 5}}}\n"
            "cts: {K: {line: L, end: to, type: c}}\nvt_types: {v: {}}\nvts: {V: {bus: B, type: v}}\n"
            "profiles: {p: {hours: [0, 1], values: [1, 0.5]}}\n"
            "loads:\n  P: {bus: C, p_kw: 40, model: constant_power, lag_s: 0.1, scale: p}\n"
            "  D: {bus: C, p_kw: 10, model: dc_constant_power}\n"
            "pv: {P1: {bus: C, p_kw: 20, scale: p}}\n"
            "generators: {G: {bus: C, role: pv, rating_kva: 50, p_kw: 5}}\n"
            "batteries: {X: {bus: C, capacity_kwh: 1, rating_kva: 20, p_kw: 10}}\n"
            "electrolysers: {Y: {bus: C, rated_kw: 26, p_kw: 20, ramp_up_s: 0.1, scale: p}}\n"
            "supercapacitors: {U: {bus: C, capacitance_f: 10, rated_voltage_v: 200, v_min_v: 100, v_start_v: 150, "
            "rating_kva: 10, p_kw: 2, esr_ohm: 0.01, leakage_ohm: 100}}\n"
            "evs: {E: {bus: C, capacity_kwh: 1, battery_v: 360, max_current_a: 15, soc_start_percent: 20}}\n")),
        0U);
}

TEST(EmtEngineStep, AllocatesNothingOnTwoThreads) {
    std::string buses = "buses:\n", lines = "lines:\n", loads = "loads:\n";
    for (int i = 0; i < 200; ++i) {
        buses += fmt::format("  B{}: {{voltage_v: 12470}}\n", i);
        loads += fmt::format("  D{0}: {{bus: B{0}, p_kw: 10, model: constant_power}}\n", i);
        if (i > 0) {
            lines += fmt::format("  L{0}: {{from: B{1}, to: B{0}, r_ohm: 0.05, l_mh: 0.3, l0_mh: 0.9}}\n", i,
                                 i > 2 ? i - 2 : 0);
        }
    }
    EXPECT_EQ(
        allocations_of_steps(network_of(buses + lines + loads + "sources: {S: {bus: B0, r_ohm: 0.1, l_mh: 2}}\n", 2000),
                             make_thread_team(2)),
        0U);
}

TEST(EmtEngineStep, AnEventIsCounted) { // negative control
    auto const sut = started(shipped_network("adn_set_a.yaml"), kBase, Rational{1, 48000});
    advance(*sut, SimTime{1});
    std::size_t const before = allocations();
    apply(*sut, ApplyFault{"TL2", "", 50, FaultType::three_phase_ground, 0.01, "f"});
    advance(*sut, SimTime{2});
    EXPECT_GT(allocations(), before);
}

} // namespace
} // namespace gridspace::sim::emt
