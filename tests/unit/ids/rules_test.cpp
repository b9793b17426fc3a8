// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/rules/goose_rules.hpp"
#include "ids/rules/sv_rules.hpp"

#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <vector>

namespace gridspace::ids {
namespace {

SvFacts frame(std::int64_t n) {
    SvFacts f;
    f.source = {2, 0, 0, 0, 0, 1};
    f.app_id = 0x4021;
    f.sv_id_hash = 99;
    f.smp_cnt = static_cast<std::uint16_t>(n % 4800);
    f.arrival_ns = n * 1'000'000'000 / 4800;
    return f;
}

TEST(SvRules, AcceptAStreamThroughTheTurnOfTheSecond) {
    SvRules sut{{}};
    for (std::int64_t n = 4000; n < 12'000; ++n) {
        auto const v = sut.judge(frame(n));
        ASSERT_TRUE(v.accept) << n;
        ASSERT_EQ(v.findings, 0U) << n << " " << sv_finding_names(v.findings);
    }
}

TEST(SvRules, RefuseASecondPublisherWhateverItSends) {
    SvRules sut{{}};
    for (std::int64_t n = 0; n < 200; ++n) {
        EXPECT_TRUE(sut.judge(frame(n)).accept);
        SvFacts forged = frame(n + 1); // ahead of the real one
        forged.source[5] = 66;
        EXPECT_EQ(sut.judge(forged).findings, static_cast<std::uint32_t>(kWrongSource));
        forged = frame(n); // with the real address: the counter gives it away
        EXPECT_EQ(sut.judge(forged).findings, static_cast<std::uint32_t>(kDuplicate));
    }
    EXPECT_EQ(sut.counters()[0], 200U);
}

TEST(SvRules, CountWhatIsMissingAndRefuseWhatIsOld) {
    SvRules sut{{}};
    sut.judge(frame(100));
    auto const v = sut.judge(frame(104));
    EXPECT_TRUE(v.accept);
    EXPECT_EQ(v.missing, 3U);
    EXPECT_FALSE(sut.judge(frame(102)).accept);
    EXPECT_FALSE(sut.judge(frame(50)).accept);
    EXPECT_TRUE(sut.judge(frame(105)).accept);
}

TEST(SvRules, TellACopyFromASampleThatWasOvertaken) {
    SvRules sut{{}};
    auto const judge = [&](std::int64_t first) { // a frame of four samples
        std::uint32_t findings = 0;
        for (std::int64_t k = 0; k < 4; ++k) {
            SvFacts f = frame(first + k);
            f.behind_another = k > 0;
            auto const v = sut.judge(f);
            EXPECT_FALSE(v.resynchronised) << first + k;
            findings |= v.findings & ~static_cast<std::uint32_t>(kBadArrival);
        }
        return findings;
    };
    for (std::int64_t first = 4760; first < 4840; first += 4) {
        EXPECT_EQ(judge(first), 0U);
        EXPECT_EQ(judge(first), static_cast<std::uint32_t>(kDuplicate));
    }
    EXPECT_EQ(judge(4844), static_cast<std::uint32_t>(kGap));
    EXPECT_EQ(judge(4840), static_cast<std::uint32_t>(kOutOfOrder));
    EXPECT_EQ(judge(4840), static_cast<std::uint32_t>(kDuplicate));
    EXPECT_EQ(judge(4848), 0U);
}

TEST(SvRules, FollowASlowStreamOverItsSecond) {
    SvRules sut{{.rate_hz = 10, .check_arrival = false}};
    for (std::int64_t n = 0; n < 100; ++n) {
        SvFacts f = frame(n);
        f.smp_cnt = static_cast<std::uint16_t>(n % 10);
        EXPECT_EQ(sut.judge(f).findings, 0U) << n;
    }
}

TEST(SvRules, FollowARestartedPublisherAfterThreeFrames) {
    SvRules sut{{}};
    for (std::int64_t n = 1000; n < 1100; ++n) {
        sut.judge(frame(n));
    }
    EXPECT_FALSE(sut.judge(frame(10)).accept);
    EXPECT_FALSE(sut.judge(frame(11)).accept);
    auto const v = sut.judge(frame(12));
    EXPECT_TRUE(v.accept);
    EXPECT_TRUE(v.resynchronised);
    EXPECT_TRUE(sut.judge(frame(13)).accept);
}

TEST(SvRules, WatchHeaderAndArrival) {
    SvRules sut{{}};
    for (std::int64_t n = 0; n < 100; ++n) {
        sut.judge(frame(n));
    }
    SvFacts late = frame(100);
    late.arrival_ns += 400'000;
    EXPECT_EQ(sut.judge(late).findings, static_cast<std::uint32_t>(kBadArrival));
    SvFacts f = frame(101);
    f.conf_rev = 2;
    EXPECT_EQ(sut.judge(f).findings, static_cast<std::uint32_t>(kWrongIdentity));
    f = frame(101);
    f.simulated = true;
    EXPECT_FALSE(sut.judge(f).accept);
    f = frame(101);
    f.smp_cnt = 4800;
    EXPECT_FALSE(sut.judge(f).accept);
    f = frame(101);
    f.smp_synch = 0;
    auto const v = sut.judge(f);
    EXPECT_TRUE(v.accept); // the relay blocks by itself
    EXPECT_NE(v.findings & kUnsynchronised, 0U);
    SvRules without_arrival{{.check_arrival = false}};
    for (std::int64_t n = 0; n < 100; ++n) {
        SvFacts lockstep = frame(n);
        lockstep.arrival_ns = (n * 7919) % 1'000'000;
        EXPECT_EQ(without_arrival.judge(lockstep).findings, 0U);
    }
}

TEST(GooseRules, BelieveAJumpOnlyWhenItIsConfirmed) {
    GooseRules sut{{}};
    GooseFacts f;
    f.live_ms = 30;
    std::int64_t now = 0;
    auto judge = [&](std::uint32_t st, std::uint32_t sq) {
        now += 5'000'000;
        f.st_num = st;
        f.sq_num = sq;
        f.arrival_ns = now;
        f.t_ns = static_cast<std::int64_t>(st) * 1000;
        f.value_hash = st;
        return sut.judge(f);
    };
    EXPECT_TRUE(judge(1, 0).accept);
    EXPECT_TRUE(judge(1, 1).accept);
    EXPECT_EQ(judge(4, 0).findings, static_cast<std::uint32_t>(kGooseJump)); // two changes were lost
    EXPECT_TRUE(judge(4, 1).accept);
    EXPECT_EQ(judge(4, 1).findings, static_cast<std::uint32_t>(kGooseOld));
    EXPECT_EQ(judge(3, 9).findings & kGooseOld, static_cast<std::uint32_t>(kGooseOld));
    f.value_hash = 0;
    EXPECT_TRUE(judge(5, 0).accept);
}

TEST(GooseRules, SeeValuesThatChangeWithoutANewState) {
    GooseRules sut{{}};
    GooseFacts f;
    f.value_hash = 1;
    EXPECT_TRUE(sut.judge(f).accept);
    f.sq_num = 1;
    f.value_hash = 2;
    EXPECT_EQ(sut.judge(f).findings, static_cast<std::uint32_t>(kGooseSilentChange));
}

/// A message of a publisher whose address the forger writes, too. Time in ms.
GooseFacts goose(std::uint32_t st, std::uint32_t sq, std::int64_t t_ms, bool trip) {
    GooseFacts f;
    f.st_num = st;
    f.sq_num = sq;
    f.t_ns = t_ms * 1'000'000;
    f.value_hash = trip ? 1 : 0;
    f.live_ms = 30;
    return f;
}

struct Forgery {
    char const* name;
    std::array<GooseFacts, 3> messages;
};
/// Beside a publisher in state 5 since 1000 ms, which trips (state 6) at 2000 ms.
std::vector<Forgery> const kForgeries{
    {"the next state, and on", {goose(6, 0, 1990, false), goose(6, 1, 1990, false), goose(6, 2, 1990, false)}},
    {"the next state, from a later time",
     {goose(6, 0, 9000, false), goose(6, 1, 9000, false), goose(6, 2, 9000, false)}},
    {"three states", {goose(6, 0, 1990, false), goose(7, 0, 1991, false), goose(8, 0, 1992, false)}},
    {"a jump that is confirmed", {goose(900, 0, 9000, false), goose(900, 1, 9000, false), goose(900, 2, 9000, false)}},
    {"two jumps", {goose(900, 0, 9000, false), goose(900, 1, 9000, false), goose(5000, 0, 9001, false)}},
    {"a lower one", {goose(3, 0, 1500, false), goose(3, 1, 1500, false), goose(3, 2, 1500, false)}},
    {"its own state, with the next numbers",
     {goose(5, 9, 1000, false), goose(5, 10, 1000, false), goose(5, 11, 1000, false)}},
};

/// How many of all orders of two real messages (the last of state 5, the trip) and three forged ones let the trip
/// through; `heard_before`: the real publisher's state is known.
int trips_let_through(Forgery const& forgery, bool heard_before, bool accept_in_contest) {
    std::array<GooseFacts, 2> const real{goose(5, 8, 1000, false), goose(6, 0, 2000, true)};
    int through = 0;
    for (std::uint32_t order = 0; order < 32; ++order) { // a bit for each place: a real one
        if (std::popcount(order) != 2) {
            continue;
        }
        GooseRules sut{{.check_clock = false, .accept_in_contest = accept_in_contest}};
        std::int64_t now_ns = 2'000'000'000;
        auto const judge = [&](GooseFacts f) {
            f.arrival_ns = now_ns += 3'000'000;
            return sut.judge(f).accept;
        };
        if (heard_before) {
            EXPECT_TRUE(judge(goose(5, 7, 1000, false)));
        }
        std::size_t reals = 0, forged = 0;
        for (unsigned place = 0; place < 5; ++place) {
            if (((order >> place) & 1U) == 0) {
                judge(forgery.messages[forged++]);
            } else if (bool const accepted = judge(real[reals++]); reals == 2) {
                through += accepted ? 1 : 0;
            }
        }
    }
    return through;
}

TEST(GooseRules, LetATripThroughInAllOrdersOfTwoRealAndThreeForgedMessages) {
    for (Forgery const& forgery : kForgeries) {
        for (bool const heard_before : {true, false}) {
            EXPECT_EQ(trips_let_through(forgery, heard_before, true), 10) << forgery.name << ", " << heard_before;
        }
    }
    EXPECT_LT(trips_let_through(kForgeries[0], true, false), 10)
        << "a forger holds it back where no contest is accepted";
}

TEST(GooseRules, SeeAContestWhereTheRealPublisherGoesOn) {
    GooseRules sut{{.check_clock = false}};
    std::int64_t now_ns = 0;
    auto const judge = [&](GooseFacts f) {
        f.arrival_ns = now_ns += 3'000'000;
        return sut.judge(f);
    };
    EXPECT_TRUE(judge(goose(5, 0, 1, false)).accept);
    EXPECT_TRUE(judge(goose(6, 0, 2, true)).accept) << "forged, and nothing shows it";
    auto const real = judge(goose(5, 1, 1, false));
    EXPECT_FALSE(real.accept) << "says nothing new";
    EXPECT_EQ(real.findings, static_cast<std::uint32_t>(kGooseOld | kGooseContest));
    EXPECT_FALSE(judge(goose(5, 1, 1, false)).accept) << "a copy is a copy";
    now_ns += 1'000'000'000;
    EXPECT_EQ(judge(goose(6, 1, 2, true)).findings, 0U) << "one of them is silent: it is over";
    EXPECT_EQ(judge(goose(7, 0, 900, false)).findings, 0U);
}

TEST(GooseRules, KeepTheRunningStateOfThePublisherWhateverIsForgedBesideIt) {
    GooseRules sut{{.check_clock = false, .burst = 100'000}};
    std::int64_t now_ns = 0;
    std::uint32_t sq = 0;
    EXPECT_TRUE(sut.judge(goose(5, sq++, 1000, false)).accept);
    for (std::uint32_t n = 0; n < 1000; ++n) {
        GooseFacts forged = goose(6 + n, 0, 5000 + n, false);
        forged.arrival_ns = now_ns += 1'000'000;
        sut.judge(forged);
        if (n % 10 == 0) {
            GooseFacts real = goose(5, sq++, 1000, false);
            real.arrival_ns = now_ns;
            EXPECT_NE(sut.judge(real).findings & kGooseContest, 0U) << n;
        }
    }
    GooseFacts trip = goose(6, 0, 2000, true);
    trip.arrival_ns = now_ns;
    EXPECT_TRUE(sut.judge(trip).contested);
}

} // namespace
} // namespace gridspace::ids
