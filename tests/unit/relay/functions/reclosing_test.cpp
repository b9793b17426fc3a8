// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/reclosing.hpp"
#include "agents/relay/functions/synchrocheck.hpp"
#include "tests/unit/relay/functions/signals.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

using State = Rrec::State;

RrecParams shots(std::vector<double> dead_times_s) {
    RrecParams p;
    p.dead_times_s = std::move(dead_times_s);
    p.open_below_a = 10;
    return p;
}

Measurement const kLoad = measurement(balanced(100)), kOpen = measurement(balanced(0));

TEST(Rrec, ClosesAfterTheDeadTimeAndIsReadyAfterTheReclaimTime) {
    Rrec sut{shots({0.5})};
    (void)sut.step({kLoad, {}, false});
    (void)after(sut, kLoad, 0.05, true); // tripped, and still current
    EXPECT_EQ(sut.state(), State::wait_open);
    EXPECT_NEAR(time_to_operate(sut, kOpen, 1, true), 0.5, 2 / kRateHz);
    EXPECT_FALSE(after(sut, kLoad, 0.2, false).op); // the command is a pulse
    EXPECT_EQ(sut.state(), State::reclaim);
    (void)after(sut, kLoad, 10.1, false);
    EXPECT_EQ(sut.state(), State::ready);
}

TEST(Rrec, LocksOutAfterItsLastShot) {
    Rrec sut{shots({0.3, 2})};
    for (double const dead_s : {0.3, 2.0}) {
        (void)sut.step({kLoad, {}, false});
        EXPECT_NEAR(time_to_operate(sut, kOpen, 5, true), dead_s, 3 / kRateHz);
        (void)after(sut, kLoad, 0.3, false);
    }
    (void)after(sut, kLoad, 0.01, true);
    EXPECT_EQ(sut.state(), State::lockout);
    EXPECT_LT(time_to_operate(sut, kOpen, 5, true), 0);
    sut.unlock();
    EXPECT_EQ(sut.state(), State::ready);
}

TEST(Rrec, DoesNotCloseABreakerThatDidNotOpen) {
    Rrec sut{shots({0.3})};
    (void)sut.step({kLoad, {}, false});
    EXPECT_LT(time_to_operate(sut, kLoad, 5, true), 0);
    EXPECT_EQ(sut.state(), State::lockout);
}

TEST(Rrec, WaitsForTheSynchrocheckAndGivesUpWithoutIt) {
    RrecParams p = shots({0.3});
    p.synchrocheck = 0;
    std::array<FunctionState, 1> others{};
    for (bool const released : {true, false}) {
        Rrec sut{p};
        (void)sut.step({kLoad, others, false});
        FunctionState state;
        others[0].op = false;
        for (int k = 0; k < 0.5 * kRateHz; ++k) {
            state = sut.step({kOpen, others, true});
        }
        EXPECT_EQ(sut.state(), State::wait_release);
        others[0].op = released;
        for (int k = 0; k < 6 * kRateHz && !state.op; ++k) {
            state = sut.step({kOpen, others, true});
        }
        EXPECT_EQ(state.op, released);
    }
}

RsynParams synchrocheck() {
    RsynParams p;
    p.nominal_hz = 60;
    p.live_v = 50;
    p.dead_v = 10;
    p.difference_v = 10;
    p.hold_s = 0.05;
    return p;
}

/// A line against a bus that turns by `slip_hz`, from `degrees` on.
bool releases(RsynParams const& p, double line_v, double bus_v, double degrees, double slip_hz = 0) {
    Rsyn sut{p};
    FunctionState out;
    for (int k = 0; k < 0.1 * kRateHz; ++k) {
        Measurement m = measurement({}, balanced(line_v));
        m.bus_v = balanced(polar(bus_v, degrees + 360 * slip_hz * k / kRateHz));
        out = sut.step({m, {}, false});
    }
    return out.op;
}

TEST(Rsyn, ReleasesWhatIsAlikeAndNotWhatIsJustBeyond) {
    EXPECT_TRUE(releases(synchrocheck(), 100, 100, 0));
    EXPECT_TRUE(releases(synchrocheck(), 100, 109.9, 0));
    EXPECT_FALSE(releases(synchrocheck(), 100, 110.1, 0));
    EXPECT_TRUE(releases(synchrocheck(), 100, 100, 19.9));
    EXPECT_FALSE(releases(synchrocheck(), 100, 100, -20.1));
    EXPECT_TRUE(releases(synchrocheck(), 100, 100, 0, 0.09));
    EXPECT_FALSE(releases(synchrocheck(), 100, 100, 0, 0.11));
    EXPECT_FALSE(releases(synchrocheck(), 100, 100, 0, -0.11));
}

TEST(Rsyn, ReleasesOntoADeadLineOnlyWhereThatIsAllowed) {
    EXPECT_FALSE(releases(synchrocheck(), 0, 100, 0));
    RsynParams p = synchrocheck();
    p.dead_line = true;
    EXPECT_TRUE(releases(p, 9, 100, 0));
    EXPECT_FALSE(releases(p, 11, 100, 0)); // neither dead nor live
    EXPECT_FALSE(releases(p, 100, 0, 0));  // a dead bus is another thing
    p.dead_bus = true;
    EXPECT_TRUE(releases(p, 100, 0, 0));
}

} // namespace
} // namespace gridspace::relay
