// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/stream_alignment.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kPeriod = 208'333;
using Alignment = StreamAlignment<int>;
constexpr std::int64_t kTimeout = 3'150'000;

std::vector<std::pair<std::int64_t, std::pair<int, int>>> drain(Alignment& sut, std::int64_t now) {
    std::vector<std::pair<std::int64_t, std::pair<int, int>>> out;
    while (auto const pair = sut.pop(now)) {
        out.emplace_back(pair->index, std::pair{pair->first.value_or(-1), pair->second.value_or(-1)});
    }
    return out;
}

auto entry(std::int64_t index, int a, int b) {
    return std::pair{index, std::pair{a, b}};
}

TEST(StreamAlignment, PairsByCounterHoweverTheStreamsAreDelayed) {
    Alignment sut{kTimeout, 4800};
    for (int i = 10; i < 15; ++i) {
        sut.push(0, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
    }
    EXPECT_TRUE(drain(sut, 15 * kPeriod).empty());
    for (int i = 10; i < 13; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, 15 * kPeriod);
    }
    EXPECT_THAT(drain(sut, 15 * kPeriod), ElementsAre(entry(10, 10, 110), entry(11, 11, 111), entry(12, 12, 112)));
}

TEST(StreamAlignment, GivesALostSampleAsAHoleAsSoonAsItIsCertain) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0);
    sut.push(1, 0, 2, 2, 0);
    sut.push(0, 1, 2, 3, kPeriod);
    EXPECT_THAT(drain(sut, kPeriod), ElementsAre(entry(0, 1, 2)));
    sut.push(1, 2, 2, 4, 2 * kPeriod); // stream 1 has no sample 1
    EXPECT_THAT(drain(sut, 2 * kPeriod), ElementsAre(entry(1, 3, -1)));
    sut.push(0, 2, 2, 5, 2 * kPeriod);
    EXPECT_THAT(drain(sut, 2 * kPeriod), ElementsAre(entry(2, 5, 4)));
    EXPECT_EQ(sut.counters().second_missing, 1U);
}

TEST(StreamAlignment, DoesNotWaitForAPartnerLongerThanItsTimeout) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 7, 1'000);
    EXPECT_EQ(sut.deadline(), 1'000 + kTimeout);
    EXPECT_TRUE(drain(sut, kTimeout).empty());
    EXPECT_THAT(drain(sut, kTimeout + 1'000), ElementsAre(entry(0, 7, -1)));
    sut.push(1, 0, 2, 8, kTimeout + 2'000);
    EXPECT_TRUE(drain(sut, kTimeout + 2'000).empty());
    EXPECT_EQ(sut.counters().too_late, 1U);
}

TEST(StreamAlignment, GivesOutWhatIsAloneHoweverManySamplesPassWithinTheTimeout) {
    for (std::uint32_t const rate : {4800U, 15'360U, 65'535U}) {
        std::int64_t const period = 1'000'000'000 / rate;
        Alignment sut{20'000'000, rate};
        std::int64_t expected = 0;
        for (std::int64_t i = 0; i < rate; ++i) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, 1, i * period);
            for (auto const& [index, pair] : drain(sut, i * period)) {
                ASSERT_EQ(index, expected++);
                ASSERT_EQ(pair, (std::pair{1, -1}));
                ASSERT_GE((i - index) * period, 20'000'000);
            }
        }
        EXPECT_NEAR(static_cast<double>(expected), 0.98 * rate, 2) << "all but those of the last 20 ms";
        EXPECT_EQ(sut.counters().restarts, 0U);
    }
}

/// Two frames of four samples of stream 0 as far as 8, of stream 1 without those from 4 on.
Alignment one_frame_missing(std::int64_t bridged) {
    Alignment sut{kTimeout, 4800, 0, {2 * 4 * kPeriod, bridged}};
    for (int first = 0; first < 12; first += 4) {
        for (int i = first; i < first + 4; ++i) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, i, (first + 4) * kPeriod);
            if (first != 4) {
                sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, (first + 4) * kPeriod);
            }
        }
    }
    return sut;
}

TEST(StreamAlignment, WaitsForAFrameThatWasOvertaken) {
    Alignment sut = one_frame_missing(3);
    EXPECT_EQ(drain(sut, 12 * kPeriod).size(), 4U);
    EXPECT_EQ(sut.deadline(), 12 * kPeriod + 8 * kPeriod);
    for (int i = 4; i < 8; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, 12 * kPeriod + 1);
        EXPECT_THAT(drain(sut, 12 * kPeriod + 1), testing::Contains(entry(i, i, 100 + i)));
    }
    EXPECT_EQ(sut.counters().pairs, 12U) << "what came behind it waited no longer";
    EXPECT_EQ(sut.counters().second_missing + sut.counters().too_late, 0U);
}

TEST(StreamAlignment, GivesAFrameUpThatDoesNotComeLateEither) {
    Alignment sut = one_frame_missing(3);
    EXPECT_EQ(drain(sut, 20 * kPeriod - 1).size(), 4U);
    auto const out = drain(sut, 20 * kPeriod);
    ASSERT_EQ(out.size(), 8U);
    EXPECT_EQ(out[3], entry(7, 7, -1));
    EXPECT_EQ(out[4], entry(8, 8, 108));
}

TEST(StreamAlignment, DoesNotWaitForWhatIsBridged) {
    Alignment sut = one_frame_missing(4);
    EXPECT_EQ(drain(sut, 12 * kPeriod).size(), 12U);
}

TEST(StreamAlignment, DoesNotGiveAHoleUpBeforeTheOtherStreamIsThere) {
    Alignment sut{kTimeout, 4800, 0, {2 * kPeriod, 3}};
    for (int i = 0; i < 10; ++i) {
        if (i < 4 || i == 9) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
        }
    }
    std::int64_t const late = 13 * kPeriod; // stream 1 is on a slower way
    EXPECT_TRUE(drain(sut, late).empty());
    for (int i = 0; i < 10; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, late);
    }
    auto const out = drain(sut, late);
    ASSERT_EQ(out.size(), 10U);
    EXPECT_EQ(out[4], entry(4, -1, 104));
    EXPECT_EQ(sut.counters().too_late, 0U);
}

TEST(StreamAlignment, CountsHolesOfBothStreamsThatFollowEachOther) {
    Alignment sut{kTimeout, 4800, 0, {8 * kPeriod, 3}};
    for (int i = 0; i < 8; ++i) { // 1 and 2 of one stream, 3 and 4 of the other one: four in a row
        for (std::size_t stream = 0; stream < 2; ++stream) {
            if (i == 0 || i > 4 || (i < 3) != (stream == 0)) {
                sut.push(stream, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
            }
        }
        drain(sut, i * kPeriod);
    }
    EXPECT_GT(sut.counters().pairs, 1U) << "the first holes are bridged as far as anybody knows";
    EXPECT_LT(sut.counters().pairs, 8U) << "the fourth one is not";
    drain(sut, 5 * kPeriod + 8 * kPeriod);
    EXPECT_EQ(sut.counters().pairs, 8U);
}

TEST(StreamAlignment, JoinsStreamsOnBothSidesOfTheWrap) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0); // already in the new second
    sut.push(1, 4799, 2, 2, 0);
    sut.push(1, 0, 2, 3, kPeriod);
    auto const pairs = drain(sut, kPeriod);
    ASSERT_EQ(pairs.size(), 2U);
    EXPECT_EQ(pairs[0].second, (std::pair{-1, 2}));
    EXPECT_EQ(pairs[1].second, (std::pair{1, 3}));
}

TEST(StreamAlignment, SaysWhetherTheClocksAreTheSame) {
    EXPECT_TRUE(same_clock(2, 2));
    EXPECT_TRUE(same_clock(1, 1));
    EXPECT_TRUE(same_clock(17, 17));
    EXPECT_FALSE(same_clock(0, 0));
    EXPECT_FALSE(same_clock(1, 2));
    EXPECT_FALSE(same_clock(17, 18));
    EXPECT_FALSE(same_clock(3, 3)) << "reserved";
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0);
    sut.push(1, 0, 0, 1, 0);
    EXPECT_FALSE(sut.pop(0)->coherent());
}

TEST(StreamAlignment, HoldsAPairBackAndShowsItMeanwhile) {
    Alignment sut{kTimeout, 4800, 1};
    std::uint16_t const last = 4799;
    sut.push(0, last, 2, 1, 0, {.restarted = true});
    sut.push(1, last, 2, 2, 0, {.restarted = true});
    EXPECT_FALSE(sut.pop(0));
    ASSERT_NE(sut.waiting(0, last), nullptr);
    *sut.waiting(0, last) = 7;
    EXPECT_EQ(sut.waiting(0, 0), nullptr) << "not here yet";
    sut.push(0, 0, 2, 3, kPeriod);
    EXPECT_FALSE(sut.pop(kPeriod)) << "the other stream may still say something";
    sut.push(1, 0, 2, 4, kPeriod);
    auto const pair = sut.pop(kPeriod);
    ASSERT_TRUE(pair);
    EXPECT_EQ(*pair->first, 7);
    EXPECT_EQ(sut.waiting(0, last), nullptr) << "given out";
    EXPECT_NE(sut.waiting(0, 0), nullptr) << "behind the wrap";
    auto const by_time = sut.pop(kPeriod + kTimeout);
    ASSERT_TRUE(by_time) << "nothing waits for ever";
    EXPECT_EQ(*by_time->second, 4);
}

TEST(StreamAlignment, BeginsAnewAfterAJumpOfBothStreams) {
    Alignment sut{kTimeout, 4800};
    for (std::size_t stream : {0U, 1U}) {
        sut.push(stream, 0, 2, 1, 0);
    }
    EXPECT_EQ(drain(sut, 0).size(), 1U);
    for (std::size_t stream : {0U, 1U}) {
        sut.push(stream, 2000, 2, 5, kPeriod, {.restarted = true});
    }
    EXPECT_THAT(drain(sut, kPeriod), ElementsAre(entry(2000, 5, 5)));
}

TEST(StreamAlignment, JoinsAStreamThatWasSilentForMoreThanHalfOfAWrap) {
    Alignment sut{kTimeout, 4800};
    for (std::int64_t i = 0; i <= 3400; ++i) {
        auto const count = static_cast<std::uint16_t>(i);
        sut.push(0, count, 2, 1, i * kPeriod);
        if (i == 0 || i == 3400) {
            sut.push(1, count, 2, 2, i * kPeriod, {.samples = i == 0 ? 1 : 3400});
        }
        if (i < 3400) {
            drain(sut, i * kPeriod);
        }
    }
    EXPECT_EQ(drain(sut, 3400 * kPeriod).back(), entry(3400, 1, 2));
    EXPECT_EQ(sut.counters().too_late, 0U);
}

TEST(StreamAlignment, GoesOnBehindASilenceOfBothStreamsAndNotBesideIt) {
    for (std::int64_t const silent : {2000, 3000, 4800, 8000, 9600}) {
        bool const restarted = silent > 4800; // as a subscriber judges it
        Alignment sut{kTimeout, 4800};
        for (std::size_t stream : {0U, 1U}) {
            sut.push(stream, 7, 2, 1, 0);
        }
        EXPECT_THAT(drain(sut, 0), ElementsAre(entry(7, 1, 1)));
        for (std::size_t stream : {0U, 1U}) {
            sut.push(stream, static_cast<std::uint16_t>((7 + silent) % 4800), 2, 2, silent * kPeriod,
                     {silent, restarted});
        }
        EXPECT_THAT(drain(sut, silent * kPeriod), ElementsAre(entry(7 + silent, 2, 2))) << silent;
    }
}

TEST(SampleHold, BridgesOneSampleAndNotTwo) {
    using State = SampleHold::State;
    SampleHold sut{1, 3};
    EXPECT_EQ(sut.step(true), State::invalid) << "nothing is known about the stream yet";
    sut.step(true);
    EXPECT_EQ(sut.step(true), State::good);
    EXPECT_EQ(sut.step(false), State::held);
    EXPECT_EQ(sut.step(true), State::good);
    EXPECT_EQ(sut.step(false), State::held);
    EXPECT_EQ(sut.step(false), State::invalid);
    EXPECT_EQ(sut.step(true), State::invalid);
    EXPECT_EQ(sut.step(true), State::invalid);
    EXPECT_EQ(sut.step(true), State::good);
}

} // namespace
} // namespace gridspace::iec61850
