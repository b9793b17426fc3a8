// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line.hpp"

#include <gtest/gtest.h>

namespace gridspace::gateways {
namespace {

using Action = FirstLineConfig::Action;

struct SampleOf {
    iec61850::FrameHeader header;
    iec61850::Asdu asdu;
};

/// Frame `n` of a stream of 4800 samples a second, from the address that ends in `source`.
SampleOf sample(std::int64_t n, std::uint8_t source = 1) {
    SampleOf out;
    out.header.source.octets = {2, 0, 0, 0, 0, source};
    out.header.app_id = 0x4021;
    out.asdu.sv_id = "SMV21";
    out.asdu.dat_set = "ADN/LLN0$Currents";
    out.asdu.conf_rev = 1;
    out.asdu.smp_cnt = static_cast<std::uint16_t>(n % 4800);
    out.asdu.smp_synch = 2;
    return out;
}
std::int64_t sample_ns(std::int64_t n) { return n * 1'000'000'000 / 4800; }

FirstLineVerdict judge(SvFirstLine& sut, SampleOf const& s, std::int64_t at_ns) { return sut.judge(s.header, s.asdu, true, at_ns); }

iec61850::GooseFrame message(std::uint32_t st_num, std::uint32_t sq_num, std::int64_t t_ns, std::uint8_t source = 1) {
    static constexpr std::array<std::uint8_t, 3> kFalse{0x83, 1, 0};
    iec61850::GooseFrame out;
    out.header.source.octets = {2, 0, 0, 0, 0, source};
    out.header.app_id = 0x3001;
    out.gocb_ref = "R/LLN0$GO$trip";
    out.dat_set = "R/LLN0$trip";
    out.t = iec61850::UtcTime::from_nanoseconds(t_ns);
    out.live_ms = 2000;
    out.st_num = st_num;
    out.sq_num = sq_num;
    out.conf_rev = 1;
    out.entries = 1;
    out.all_data = kFalse;
    return out;
}

FirstLineConfig with(Action action) {
    FirstLineConfig out;
    out.action = action;
    return out;
}

TEST(FirstLine, ASecondPublisherOfSamplesIsRefusedAndSaidOnceASecond) {
    SvFirstLine sut{with(Action::drop), streams::Stream{}, true};
    int lines = 0;
    for (std::int64_t n = 0; n < 9600; ++n) { // 2 s
        ASSERT_TRUE(judge(sut, sample(n), sample_ns(n)).pass) << n;
        auto const forged = judge(sut, sample(n + 1, 66), sample_ns(n));
        ASSERT_FALSE(forged.pass) << n;
        ASSERT_EQ(forged.findings, static_cast<std::uint32_t>(ids::kWrongSource));
        lines += forged.news != 0 ? 1 : 0;
    }
    EXPECT_EQ(sut.counters().refused, 9600U);
    EXPECT_EQ(sut.counters().suspicious, 9600U);
    EXPECT_EQ(lines, 1) << "it never stopped: one line says so";
    (void)judge(sut, sample(9600), sample_ns(9600));
    auto const again = judge(sut, sample(9601, 66), sample_ns(9600) + 1'500'000'000);
    EXPECT_NE(again.news, 0U) << "after a quiet second it is news again";
}

TEST(FirstLine, AnAlarmTakesTheFrameAndOffSeesNothing) {
    SvFirstLine alarm{with(Action::alarm), streams::Stream{}, true}, off{with(Action::off), streams::Stream{}, true};
    for (SvFirstLine* sut : {&alarm, &off}) {
        (void)judge(*sut, sample(0), 0);
        EXPECT_TRUE(judge(*sut, sample(1, 66), sample_ns(1)).pass);
    }
    EXPECT_EQ(alarm.counters().suspicious, 1U);
    EXPECT_EQ(alarm.counters().refused, 0U);
    EXPECT_EQ(off.counters().suspicious, 0U);
}

TEST(FirstLine, LostSamplesAndTheSamplesOfOneFrameAreNoForgery) {
    SvFirstLine sut{with(Action::drop), streams::Stream{}, false};
    std::int64_t n = 0;
    for (int frame = 0; frame < 400; ++frame) {
        n += frame % 50 == 49 ? 7 : 0; // seven are lost
        for (int k = 0; k < 2; ++k, ++n) {
            SampleOf const s = sample(n);
            auto const verdict = sut.judge(s.header, s.asdu, k == 0, sample_ns(n - k));
            ASSERT_TRUE(verdict.pass) << n;
            ASSERT_EQ(verdict.findings, 0U) << ids::sv_finding_names(verdict.findings);
        }
    }
    EXPECT_EQ(sut.counters().odd_arrivals, 0U);
}

TEST(FirstLine, AnOddArrivalIsCountedAndNeverRefused) {
    SvFirstLine sut{with(Action::drop), streams::Stream{}, false};
    for (std::int64_t n = 0; n < 200; ++n) {
        std::int64_t const late_ns = n == 150 ? 5'000'000 : 0;
        ASSERT_TRUE(judge(sut, sample(n), sample_ns(n) + late_ns).pass);
    }
    EXPECT_EQ(sut.counters().odd_arrivals, 2U) << "the late one, and the one that seems to follow too soon";
    EXPECT_EQ(sut.counters().suspicious, 0U);
}

TEST(FirstLine, AForgedStateOfAnotherSourceNeverReachesTheSubscriber) {
    GooseFirstLine sut{with(Action::drop), streams::Stream{}};
    ASSERT_TRUE(sut.judge(message(1, 0, 0), 0).pass);
    for (std::uint32_t k = 0; k < 20; ++k) {
        std::int64_t const now = (k + 1) * 10'000'000LL;
        EXPECT_FALSE(sut.judge(message(2, k, now, 66), now).pass) << k;
    }
    EXPECT_TRUE(sut.judge(message(1, 1, 0), 500'000'000).pass) << "and the real publisher goes on";
    EXPECT_TRUE(sut.judge(message(2, 0, 600'000'000), 600'000'000).pass);
    EXPECT_EQ(sut.counters().refused, 20U);
}

TEST(FirstLine, ARestartedPublisherOfGooseIsTakenWhenItsOldStateHasExpired) {
    GooseFirstLine sut{with(Action::drop), streams::Stream{}};
    ASSERT_TRUE(sut.judge(message(7, 3, 0), 0).pass);
    EXPECT_FALSE(sut.judge(message(1, 0, 100'000'000), 100'000'000).pass) << "that may be a replay";
    sut.expired();
    EXPECT_TRUE(sut.judge(message(1, 1, 100'000'000), 3'000'000'000).pass);
}

TEST(FirstLine, WithAlarmsOnlyTheRulesFollowTheSubscriberToARestartedPublisher) {
    GooseFirstLine sut{with(Action::alarm), streams::Stream{}};
    (void)sut.judge(message(7, 3, 0), 0);
    EXPECT_NE(sut.judge(message(1, 0, 100'000'000), 100'000'000).findings, 0U);
    for (std::uint32_t k = 1; k < 10; ++k) {
        EXPECT_EQ(sut.judge(message(1, k, 100'000'000), 100'000'000 + k * 10'000'000).findings, 0U) << k;
    }
}

TEST(FirstLine, AChangeWithoutANewStateIsSuspicious) {
    static constexpr std::array<std::uint8_t, 3> kTrue{0x83, 1, 0xFF};
    GooseFirstLine sut{with(Action::drop), streams::Stream{}};
    (void)sut.judge(message(1, 0, 0), 0);
    auto changed = message(1, 1, 0);
    changed.all_data = kTrue;
    auto const verdict = sut.judge(changed, 10'000'000);
    EXPECT_FALSE(verdict.pass);
    EXPECT_EQ(verdict.findings, static_cast<std::uint32_t>(ids::kGooseSilentChange));
}

} // namespace
} // namespace gridspace::gateways
