// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/sv_publisher.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kPeriod = 208'333;

TEST(SampleGrid, NeverAddsUpRoundedPeriods) {
    SampleGrid const sut{Rational{4800}};
    EXPECT_EQ(sut.nanoseconds(0), 0);
    EXPECT_EQ(sut.nanoseconds(1), 208'333);
    EXPECT_EQ(sut.nanoseconds(2), 416'667);
    EXPECT_EQ(sut.nanoseconds(3), 625'000);
    EXPECT_EQ(sut.nanoseconds(4800LL * 86'400 * 365), 86'400LL * 365 * 1'000'000'000);
    EXPECT_EQ(sut.nanoseconds(-1), -208'333);
}

TEST(SvPublisher, GivesAFrameOutWithItsLastSampleAndWrapsOnTheSecond) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(2, asdu("MU", 4))), 4800};
    (void)sut.sample(4798);
    EXPECT_TRUE(sut.commit().empty());
    (void)sut.sample(4799);
    SvFrame frame;
    ASSERT_TRUE(decode_sv(sut.commit(), frame));
    EXPECT_EQ(frame.asdus[0].smp_cnt, 4798);
    EXPECT_EQ(frame.asdus[1].smp_cnt, 4799);
    (void)sut.sample(4800);
    (void)sut.sample(4801);
    ASSERT_TRUE(decode_sv(sut.commit(), frame));
    EXPECT_EQ(frame.asdus[0].smp_cnt, 0);
    EXPECT_EQ(sut.sent(), 2U);
}

TEST(SvPublisher, SendsOnlyFramesOfConsecutiveSamples) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(2, asdu("MU", 4))), 4800};
    std::vector<std::pair<int, int>> frames;
    // From the middle of a frame; 7 to 9 are missing, then 16; 18 and 19 come twice; back to 4 of an earlier second.
    for (std::int64_t const index : {3, 4, 5, 6, 10, 11, 12, 13, 14, 15, 17, 18, 19, 18, 19, 20, 21, 4, 5}) {
        (void)sut.sample(index);
        SvFrame frame;
        if (auto const octets = sut.commit(); !octets.empty()) {
            ASSERT_TRUE(decode_sv(octets, frame));
            frames.emplace_back(frame.asdus[0].smp_cnt, frame.asdus[1].smp_cnt);
        }
    }
    EXPECT_THAT(frames, ElementsAre(std::pair{4, 5}, std::pair{10, 11}, std::pair{12, 13}, std::pair{14, 15},
                                    std::pair{18, 19}, std::pair{20, 21}, std::pair{4, 5}));
    EXPECT_EQ(sut.sent(), 7U);
}

TEST(SvPublisher, CountsTheFramesThatLackedASample) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(4, asdu("MU", 4))), 4800};
    for (std::int64_t const index : {2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 18}) {
        (void)sut.sample(index);
        (void)sut.commit();
    }
    EXPECT_EQ(sut.sent(), 2U);
    EXPECT_EQ(sut.incomplete(), 1U) << "8 to 11: it began at 2, and 16 to 19 may still come";
}

TEST(SendSchedule, OwesEverySampleOnceHoweverLateItWakes) {
    SendSchedule sut{Rational{4800}, 1, 1'000'000};
    EXPECT_EQ(sut.owed(999'999, 16), 0U);
    EXPECT_EQ(sut.owed(1'000'000, 16), 1U);
    sut.sent(1);
    EXPECT_EQ(sut.late_wakeups(), 0U);
    std::int64_t frames = 1;
    std::int64_t const now = 1'000'000 + 100 * kPeriod;
    while (std::size_t const owed = sut.owed(now, 16)) {
        frames += static_cast<std::int64_t>(owed);
        sut.sent(owed);
    }
    EXPECT_EQ(frames, 100);
    EXPECT_EQ(sut.next_frame(), 100);
    EXPECT_GT(sut.late_wakeups(), 0U);
    EXPECT_NEAR(static_cast<double>(sut.worst_late_ns()), 99.0 * kPeriod, 100);
}

TEST(SendSchedule, SendsAFrameOfTwoSamplesAtTheTimeOfItsSecond) {
    SendSchedule const sut{Rational{4800}, 2, 0};
    EXPECT_EQ(sut.due_ns(), 208'333);
}

} // namespace
} // namespace gridspace::iec61850
