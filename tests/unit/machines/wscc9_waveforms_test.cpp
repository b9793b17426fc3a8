// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/emt/emt_fixture.hpp"
#include "tests/unit/machines/wscc9_space_vectors.hpp"

#include <cmath>
#include <gtest/gtest.h>

/// Why the critical clearing time of WSCC 9-bus is longer in waveforms than the classical 0.162 s: the direct current
/// that machines and lines keep of the state before the fault brakes them in its first half cycle.
namespace gridspace::sim {
namespace {

using emt::advance;
using emt::apply;
using emt::read;

constexpr int kHz = 24000;
TimeBase const kStep{Rational{1, kHz}};

/// Poles that part at once, as the integration has them.
Network with_breakers_that_part_at_once() {
    Network n = emt::shipped_network("wscc9_classical.yaml");
    for (BreakerType& type : n.breaker_types) {
        type.opens = BreakerType::Opens::at_once;
    }
    return n;
}

std::unique_ptr<Engine> faulted() {
    auto sut = emt::started(with_breakers_that_part_at_once(), kStep, Rational{1, kHz});
    // At the very end of line 5-7: its breakers take the fault away with it.
    apply(*sut, ApplyFault{"L57", "", 99.99, FaultType::three_phase_ground, 0, "f"});
    return sut;
}

bool stable_in_waveforms(double clearing_s) {
    auto const sut = faulted();
    int const clearing = static_cast<int>(std::lround(clearing_s * kHz));
    advance(*sut, SimTime{clearing});
    apply(*sut, SwitchBreaker{"CB57_7", false});
    apply(*sut, SwitchBreaker{"CB57_5", false});
    for (int k = clearing; k < clearing + 2 * kHz; k += kHz / 100) {
        advance(*sut, SimTime{k});
        if (!(std::abs(read(*sut, "machine.G2.angle_deg") - read(*sut, "machine.G1.angle_deg")) < 180)) {
            return false;
        }
    }
    return true;
}

constexpr double kWithDirectCurrent = 0.1744, kClassical = 0.1624, kBand = 0.005;

TEST(Wscc9Waveforms, HaveTheCriticalClearingTimeOfAnIndependentIntegrationOfTheSameEquations) {
    EXPECT_TRUE(wscc9::Integration{true}.stable((1 - kBand) * kWithDirectCurrent));
    EXPECT_FALSE(wscc9::Integration{true}.stable((1 + kBand) * kWithDirectCurrent));
    EXPECT_TRUE(stable_in_waveforms((1 - kBand) * kWithDirectCurrent));
    EXPECT_FALSE(stable_in_waveforms((1 + kBand) * kWithDirectCurrent));
}

TEST(Wscc9Waveforms, WouldHaveTheClassicalClearingTimeWithoutTheDirectCurrentOfTheFault) {
    EXPECT_TRUE(wscc9::Integration{false}.stable((1 - kBand) * kClassical));
    EXPECT_FALSE(wscc9::Integration{false}.stable((1 + kBand) * kClassical));
}

TEST(Wscc9Waveforms, BrakeTheMachinesInTheFirstHalfCycleAsTheIntegrationDoes) {
    auto const sut = faulted();
    wscc9::Integration reference{true}, without{false};
    double largest = 0;
    for (int ms = 1; ms <= 150; ++ms) {
        advance(*sut, SimTime{ms * kHz / 1000});
        reference.advance(1e-3, wscc9::Stage::fault);
        without.advance(1e-3, wscc9::Stage::fault);
        for (std::size_t k : {0U, 1U, 2U}) {
            ASSERT_NEAR(read(*sut, "machine.G" + std::to_string(k + 1) + ".speed_pu") - 1, reference.speed(k), 2e-5)
                << ms;
        }
        largest = std::max(largest, without.speed(1) - reference.speed(1));
    }
    EXPECT_NEAR(largest, 2 * 0.00118, 1e-4); // twice E i / (2 H w0) of G2, whose direct current is 5.63 p.u.
}

} // namespace
} // namespace gridspace::sim
