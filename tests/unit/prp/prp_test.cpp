// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/prp/duplicate_discard.hpp"
#include "gateways/prp/redundancy_trailer.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace gridspace::prp {
namespace {

using Frame = std::vector<std::uint8_t>;

/// A frame of `octets` from a source address that ends in `source`; tagged: with a VLAN tag.
Frame frame(std::size_t octets, bool tagged = false, std::uint8_t source = 1) {
    Frame out(octets, 0xEE);
    Frame const addresses{0x01, 0x0C, 0xCD, 0x04, 0, 1, 0x02, 0, 0, 0, 0, source};
    std::copy(addresses.begin(), addresses.end(), out.begin());
    Frame const type = tagged ? Frame{0x81, 0x00, 0x80, 0x00, 0x88, 0xBA} : Frame{0x88, 0xBA};
    std::copy(type.begin(), type.end(), out.begin() + 12);
    return out;
}

Frame with_trailer(Frame const& plain, std::uint16_t sequence, Lan lan) {
    Frame out;
    write_with_trailer(plain, {sequence, lan}, out);
    return out;
}

TEST(RedundancyTrailer, StandsAtTheEndWithTheSizeOfThePayload) {
    Frame const out = with_trailer(frame(100), 0x1234, Lan::b);
    ASSERT_EQ(out.size(), 106U);
    // 92 octets behind the ethertype, the trailer's six among them
    EXPECT_EQ(Frame(out.end() - 6, out.end()), (Frame{0x12, 0x34, 0xB0, 92, 0x88, 0xFB}));
    EXPECT_EQ(trailer_of(out), (RedundancyTrailer{0x1234, Lan::b}));
}

TEST(RedundancyTrailer, AShortFrameIsPaddedBeforeItAndATagDoesNotCount) {
    EXPECT_EQ(with_trailer(frame(30), 1, Lan::a).size(), 66U);
    Frame const tagged = with_trailer(frame(30, true), 1, Lan::a);
    EXPECT_EQ(tagged.size(), 70U);
    EXPECT_EQ(tagged[tagged.size() - 3], 52) << "66 - 14 with or without the tag";
    EXPECT_TRUE(trailer_of(tagged));
    Frame without_tag = tagged; // as a switch passes it on
    without_tag.erase(without_tag.begin() + 12, without_tag.begin() + 16);
    EXPECT_EQ(trailer_of(without_tag), (RedundancyTrailer{1, Lan::a}));
}

TEST(RedundancyTrailer, AnythingElseIsNone) {
    Frame const good = with_trailer(frame(100), 7, Lan::a);
    EXPECT_FALSE(trailer_of(frame(100)));
    for (std::size_t const at :
         {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{4}}) { // suffix, size, network
        Frame damaged = good;
        damaged[damaged.size() - at] ^= 0x40;
        EXPECT_FALSE(trailer_of(damaged)) << at;
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        EXPECT_FALSE(trailer_of(Octets{good}.first(size))) << "cut short at " << size;
    }
}

TEST(DuplicateDiscard, PassesOnTheFirstCopyFromWhicheverNetwork) {
    DuplicateDiscard sut;
    Frame const plain = frame(80);
    EXPECT_TRUE(sut.accept(with_trailer(plain, 1, Lan::a), Lan::a, 0));
    EXPECT_FALSE(sut.accept(with_trailer(plain, 1, Lan::b), Lan::b, 10));
    EXPECT_TRUE(sut.accept(with_trailer(plain, 2, Lan::b), Lan::b, 20));
    EXPECT_FALSE(sut.accept(with_trailer(plain, 2, Lan::a), Lan::a, 30));
    EXPECT_TRUE(sut.accept(with_trailer(plain, 3, Lan::b), Lan::b, 40)) << "network A has lost it";
    EXPECT_EQ(sut.counters(Lan::a).received, 2U);
    EXPECT_EQ(sut.counters(Lan::a).first, 1U);
    EXPECT_EQ(sut.counters(Lan::b).first, 2U);
}

TEST(DuplicateDiscard, SequenceNumbersBeginAnewWithoutALoss) {
    DuplicateDiscard sut;
    Frame const plain = frame(80);
    for (std::uint32_t k = 0; k < 200'000; ++k) { // three times around, 4800 a second, network B 3 ms behind
        auto const at = [](std::uint32_t n) { return std::int64_t{n} * 208'333; };
        ASSERT_TRUE(sut.accept(with_trailer(plain, static_cast<std::uint16_t>(k), Lan::a), Lan::a, at(k))) << k;
        if (k >= 15) {
            ASSERT_FALSE(sut.accept(with_trailer(plain, static_cast<std::uint16_t>(k - 15), Lan::b), Lan::b, at(k)))
                << k;
        }
    }
}

TEST(DuplicateDiscard, ANodeThatStartsAgainIsHeardAfterTheTimeToForget) {
    DuplicateDiscard sut;
    Frame const plain = frame(80);
    EXPECT_TRUE(sut.accept(with_trailer(plain, 5, Lan::a), Lan::a, 0));
    EXPECT_TRUE(sut.accept(with_trailer(plain, 5, Lan::b), Lan::b, DuplicateDiscard::kForgetNs));
}

TEST(DuplicateDiscard, NeverDiscardsWhatIsNoSecondCopy) {
    DuplicateDiscard sut;
    Frame const plain = frame(80);
    EXPECT_TRUE(sut.accept(plain, Lan::a, 0)) << "a singly attached node";
    EXPECT_TRUE(sut.accept(plain, Lan::b, 0));
    EXPECT_EQ(sut.counters(Lan::a).alone, 1U);
    EXPECT_TRUE(sut.accept(with_trailer(plain, 1, Lan::a), Lan::a, 0));
    EXPECT_TRUE(sut.accept(with_trailer(plain, 1, Lan::a), Lan::a, 1)) << "the same again on the same network";
    EXPECT_TRUE(sut.accept(with_trailer(frame(80, false, 2), 1, Lan::b), Lan::b, 2)) << "another node";
    EXPECT_TRUE(sut.accept(with_trailer(plain, 9, Lan::a), Lan::b, 3));
    EXPECT_EQ(sut.counters(Lan::b).wrong_lan, 1U);
}

TEST(DuplicateDiscard, ManySourcesTakeNoMoreMemoryAndOnlyTheOldestIsForgotten) {
    DuplicateDiscard sut;
    for (std::uint8_t source = 0; source < DuplicateDiscard::kSources + 10; ++source) {
        EXPECT_TRUE(sut.accept(with_trailer(frame(80, false, source), 1, Lan::a), Lan::a, source));
    }
    EXPECT_FALSE(sut.accept(with_trailer(frame(80, false, DuplicateDiscard::kSources), 1, Lan::b), Lan::b, 100));
    EXPECT_TRUE(sut.accept(with_trailer(frame(80, false, 0), 1, Lan::b), Lan::b, 100))
        << "forgotten: passed on, not lost";
}

} // namespace
} // namespace gridspace::prp
