// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The grid of the protection case with its fault, offline: nadirs and instants against an independent prototype of the
// same network (stated tolerances: 0.005 Hz, 0.2 ms).
#include "tests/unit/emt/emt_fixture.hpp"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::sim::emt {
namespace {

using testing::DoubleNear;

struct Outcome {
    double nadir_hz{1e9}, nadir_ms{0}, pick_up_ms{0}, command_ms{0}, opened_ms{0}, steady_hz{0};
};

struct Case {
    std::string network{"adn_set_a.yaml"};
    double fault_ohm{0.01}, inertia_h_s{0}, position{50};
    bool trip{true};
};

/// The published relay (r.m.s. difference of the line's ends over one cycle of 4800 Hz samples, 30 A), 2.1312 ms of
/// delays, and the breakers of the faulted line.
Outcome simulate(Case const& c) {
    constexpr int kPerSample = 10, kWindow = 80;
    TimeBase const base{Rational{1, 48000 * 125}};
    auto network = shipped_network(c.network);
    if (c.inertia_h_s > 0) {
        network.machine_types[0].inertia_h_s = c.inertia_h_s;
    }
    auto sut = started(std::move(network), base, Rational{1, 48000});
    std::array<std::size_t, 6> ends{};
    for (std::size_t k = 0; k < 3; ++k) {
        ends[k] = signal_of(*sut, std::string{"ct.CT21.i."} + "abc"[k]);
        ends[k + 3] = signal_of(*sut, std::string{"ct.CT22.i."} + "abc"[k]);
    }
    std::size_t const speed = signal_of(*sut, "machine.G1.frequency_hz");
    std::array<std::array<double, kWindow>, 6> window{};
    Outcome out;
    SimTime const fault = SimTime{} + base.nearest(Rational{11, 2});
    SimTime command{-1};
    auto const ms = [&](SimTime t) { return 1e3 * base.seconds(t - fault); };
    SimSpan const step = base.nearest(Rational{1, 48000});
    for (std::int64_t i = 1; i <= 48000 * 6; ++i) {
        SimTime const t = SimTime{} + step * i;
        if (command.quanta > 0 && command < t) {
            advance(*sut, command);
            apply(*sut, SwitchBreaker{"CB3", false});
            apply(*sut, SwitchBreaker{"CB4", false});
            out.command_ms = ms(command);
            command = SimTime{-1};
        }
        advance(*sut, t);
        double const f = sut->value(speed);
        if (t <= fault) {
            out.steady_hz = std::max(out.steady_hz, std::abs(f - 60));
        } else if (f < out.nadir_hz) {
            out.nadir_hz = f;
            out.nadir_ms = ms(t);
        }
        if (i % kPerSample == 0 && t > fault - base.nearest(Rational{1, 50}) && out.pick_up_ms == 0) {
            auto const slot = static_cast<std::size_t>(i / kPerSample % kWindow);
            bool picked = false;
            std::array<double, 6> rms{};
            for (std::size_t e = 0; e < 6; ++e) {
                window[e][slot] = sut->value(ends[e]);
                for (double const x : window[e]) {
                    rms[e] += x * x / kWindow;
                }
            }
            for (std::size_t k = 0; k < 3; ++k) {
                picked = picked || std::abs(std::sqrt(rms[k]) - std::sqrt(rms[k + 3])) >= 30;
            }
            if (picked && t > fault && c.trip) {
                out.pick_up_ms = ms(t);
                command = t + base.nearest(Rational{21312, 10000000});
            }
        }
        if (t == fault) {
            apply(*sut, ApplyFault{"TL2", "", c.position, FaultType::three_phase_ground, c.fault_ohm, "f"});
        }
    }
    out.opened_ms = 1e3 * (std::max(read(*sut, "breaker.CB3.opened_s"), read(*sut, "breaker.CB4.opened_s")) - 5.5);
    return out;
}

TEST(ProtectionCase, SetAReachesThePublishedNadirAndInstants) {
    Outcome const got = simulate({});
    EXPECT_THAT(got.nadir_hz, DoubleNear(59.823, 0.005));
    EXPECT_THAT(got.nadir_ms, DoubleNear(7.9, 0.2));
    EXPECT_THAT(got.pick_up_ms, DoubleNear(1.46, 0.2));
    EXPECT_THAT(got.command_ms, DoubleNear(3.59, 0.2));
    EXPECT_THAT(got.opened_ms, DoubleNear(13.1, 0.2));
    EXPECT_LT(got.steady_hz, 1e-9); // five seconds before the fault without any drift
}

TEST(ProtectionCase, SetBReachesItsNadirAndInstants) {
    Outcome const got = simulate({.network = "adn_set_b.yaml", .fault_ohm = 0.1});
    EXPECT_THAT(got.nadir_hz, DoubleNear(59.826, 0.005));
    EXPECT_THAT(got.nadir_ms, DoubleNear(8.2, 0.2));
    EXPECT_THAT(got.pick_up_ms, DoubleNear(1.67, 0.2));
    EXPECT_THAT(got.command_ms, DoubleNear(3.80, 0.2));
    EXPECT_THAT(got.opened_ms, DoubleNear(11.9, 0.2));
}

TEST(ProtectionCase, ALighterMachineDipsDeeper) {
    EXPECT_THAT(simulate({.inertia_h_s = 1}).nadir_hz, DoubleNear(59.645, 0.01));
}

TEST(ProtectionCase, WithoutATripTheBreakersStayClosed) {
    EXPECT_TRUE(std::isnan(simulate({.trip = false}).opened_ms)); // negative control of the instants above
}

} // namespace
} // namespace gridspace::sim::emt
