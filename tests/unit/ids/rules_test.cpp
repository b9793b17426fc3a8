// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/rules/goose_rules.hpp"
#include "ids/rules/sv_rules.hpp"

#include <gtest/gtest.h>

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

} // namespace
} // namespace gridspace::ids
