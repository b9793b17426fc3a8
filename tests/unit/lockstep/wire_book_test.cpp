// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/wire_book.hpp"

#include <gmock/gmock.h>

namespace gridspace::lockstep {
namespace {

std::vector<std::byte> frame(std::initializer_list<int> tail) {
    std::vector<std::byte> out(12, std::byte{0x11});
    for (int octet : tail) {
        out.push_back(static_cast<std::byte>(octet));
    }
    return out;
}

struct Sut {
    WireBook book{2, {{"process_bus", 0x88ba}, {"process_bus", 0x88b8}}};
    std::vector<WireBook::Match> matches;
    void announce(std::size_t process, std::vector<WireBook::Record> const& records, std::uint32_t incarnation = 0,
                  std::size_t channel = 0) {
        book.announced(process, incarnation, channel, records, [&](WireBook::Match const& m) { matches.push_back(m); });
    }
};

TEST(FrameIdentity, LeavesTheVlanTagOut) {
    EXPECT_EQ(frame_identity(frame({0x81, 0x00, 0x80, 0x05, 0x88, 0xba, 1, 2})),
              frame_identity(frame({0x88, 0xba, 1, 2})));
    EXPECT_NE(frame_identity(frame({0x88, 0xba, 1, 2})), frame_identity(frame({0x88, 0xba, 1, 3})));
}

TEST(WireBook, IsCompleteOnlyWhenEveryAnnouncedFrameIsHere) {
    Sut sut;
    sut.announce(0, {{1000, 7}, {2000, 8}});
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_TRUE(sut.book.complete(1));
    EXPECT_EQ(sut.book.missing(0), "2 frame(s) of ethertype 0x88ba on 'process_bus'");
    EXPECT_EQ(sut.book.arrived(0, 8, 0).send_time_ns, 2000);
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_TRUE(sut.book.arrived(0, 7, 1).matched);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, MatchesAFrameThatCameBeforeItsLedger) {
    Sut sut;
    EXPECT_FALSE(sut.book.arrived(0, 7, 5).matched);
    sut.announce(0, {{1000, 7}});
    ASSERT_EQ(sut.matches.size(), 1U);
    EXPECT_EQ(sut.matches[0].slot, 5U);
    EXPECT_EQ(sut.matches[0].send_time_ns, 1000);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, KeepsIdenticalFramesApartByNumber) {
    Sut sut;
    sut.announce(0, {{1000, 7}, {2000, 7}});
    EXPECT_EQ(sut.book.arrived(0, 7, 0).send_time_ns, 1000);
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_EQ(sut.book.arrived(0, 7, 1).send_time_ns, 2000);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, AFrameOfAnotherEthertypeDoesNotMatch) {
    Sut sut;
    sut.announce(0, {{1000, 7}});
    EXPECT_FALSE(sut.book.arrived(1, 7, 0).matched);
    EXPECT_FALSE(sut.book.complete(0));
}

TEST(WireBook, ForeignFramesAreEvictedOldestFirst) {
    Sut sut;
    std::size_t evicted = 0;
    for (std::size_t i = 0; i < 1500; ++i) {
        evicted += sut.book.arrived(0, 100 + i, i).evicted != WireBook::kUnknown ? 1 : 0;
    }
    EXPECT_EQ(evicted, 1500U - 1024U);
    EXPECT_EQ(sut.book.unannounced(), 1024U);
}

TEST(WireBook, ForgetsWhatARestartedProcessHadAnnounced) {
    Sut sut;
    sut.announce(0, {{1000, 7}});
    sut.announce(0, {}, 1);
    EXPECT_TRUE(sut.book.complete(0));
}

} // namespace
} // namespace gridspace::lockstep
