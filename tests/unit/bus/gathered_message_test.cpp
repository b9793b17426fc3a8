// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/gathered_message.hpp"

#include <gmock/gmock.h>

namespace gridspace::bus {
namespace {

using Octets = std::vector<std::uint8_t>;
using ::testing::ElementsAreArray;

constexpr std::uint8_t kData = 0x15, kDataFrag = 0x16, kInfoDst = 0x0e, kStatistics = 0x80;
constexpr std::size_t kNoLimit = 65000;

Octets joined(std::initializer_list<Octets> parts) {
    Octets out;
    for (Octets const& part : parts) {
        out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

Octets header(std::uint8_t sender = 7) {
    Octets out{'R', 'T', 'P', 'S', 2, 3, 1, 15};
    out.resize(20, sender);
    return out;
}

Octets submessage(std::uint8_t id, Octets const& body) {
    return joined({{id, 1 /*little-endian*/, static_cast<std::uint8_t>(body.size()), 0}, body});
}

Octets const kFirst = submessage(kData, Octets(8, 1)), kSecond = submessage(kData, Octets(16, 2));
Octets const kEnd = submessage(kStatistics, Octets(12, 3)), kOtherEnd = submessage(kStatistics, Octets(12, 4));

TEST(GatheredMessageTest, SeveralMessagesBecomeOneWithOneHeaderAndOneStatisticsSubmessage) {
    Octets const one = joined({header(), kFirst, kEnd}), two = joined({header(), kSecond, kOtherEnd});
    GatheredMessage sut;
    EXPECT_TRUE(sut.empty());
    sut.add(parts_of(one));
    ASSERT_TRUE(sut.takes(parts_of(two), kNoLimit));
    sut.add(parts_of(two));
    EXPECT_THAT(sut.finish(), ElementsAreArray(joined({header(), kFirst, kSecond, kOtherEnd})));
    sut.clear();
    EXPECT_TRUE(sut.empty());
}

TEST(GatheredMessageTest, WhatWasGatheredCanBeAddedToAnother) {
    Octets const one = joined({header(), kFirst, kEnd}), two = joined({header(), kSecond, kOtherEnd});
    GatheredMessage group, sut;
    group.add(parts_of(one));
    sut.add(group.parts());
    sut.add(parts_of(two));
    EXPECT_THAT(sut.finish(), ElementsAreArray(joined({header(), kFirst, kSecond, kOtherEnd})));
    EXPECT_THAT(group.finish(), ElementsAreArray(one));
}

TEST(GatheredMessageTest, TakesNothingThatMakesItTooLong) {
    Octets const one = joined({header(), kFirst, kEnd}), two = joined({header(), kSecond, kEnd});
    GatheredMessage sut;
    sut.add(parts_of(one));
    std::size_t const both = one.size() + kSecond.size();
    EXPECT_TRUE(sut.takes(parts_of(two), both));
    EXPECT_FALSE(sut.takes(parts_of(two), both - 1));
}

TEST(GatheredMessageTest, WhatIsForOneParticipantOrOfAnotherSenderStaysApart) {
    Octets const for_all = joined({header(), kFirst}), of_another = joined({header(8), kFirst}),
                 for_one = joined({header(), submessage(kInfoDst, Octets(12, 9)), kFirst}),
                 for_another = joined({header(), submessage(kInfoDst, Octets(12, 8)), kFirst});
    GatheredMessage sut;
    sut.add(parts_of(for_one));
    EXPECT_TRUE(sut.takes(parts_of(for_one), kNoLimit));
    EXPECT_FALSE(sut.takes(parts_of(for_another), kNoLimit));
    EXPECT_FALSE(sut.takes(parts_of(for_all), kNoLimit));
    sut.clear();
    sut.add(parts_of(for_all));
    EXPECT_TRUE(sut.takes(parts_of(for_all), kNoLimit));
    EXPECT_FALSE(sut.takes(parts_of(for_one), kNoLimit));
    EXPECT_FALSE(sut.takes(parts_of(of_another), kNoLimit));
}

TEST(GatheredMessageTest, OtherKindsTwoDestinationsAndWhatIsCutShortAreLeftAlone) {
    EXPECT_TRUE(parts_of(joined({header(), kFirst})).mergeable);
    EXPECT_FALSE(parts_of(joined({header(), submessage(kDataFrag, Octets(8, 1))})).mergeable);
    EXPECT_FALSE(parts_of(joined({header(), submessage(kInfoDst, Octets(12, 9)), submessage(kInfoDst, Octets(12, 8))}))
                     .mergeable);
    EXPECT_FALSE(parts_of(joined({header(), submessage(kInfoDst, Octets(8, 9))})).mergeable);
    EXPECT_FALSE(parts_of(joined({header(), {kData, 1, 0, 0}, kFirst})).mergeable); // up to the end of the message
    Octets cut = joined({header(), kFirst});
    cut.pop_back();
    EXPECT_FALSE(parts_of(cut).mergeable);
    EXPECT_FALSE(parts_of(std::span{cut}.first(12)).mergeable);
    EXPECT_FALSE(parts_of({}).mergeable);
}

} // namespace
} // namespace gridspace::bus
