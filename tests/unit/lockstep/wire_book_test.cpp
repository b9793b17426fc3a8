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

constexpr std::uint64_t kStranger = 0x020000000099, kRun = kRunAddressPrefix << 24U;

/// A frame of `source` whose content is `number`.
FrameBuffer numbered(std::uint32_t number, std::uint64_t source = kStranger) {
    auto out = std::make_unique<WireFrame>();
    out->octets.resize(12);
    for (std::size_t i = 0; i < 6; ++i) {
        out->octets[11 - i] = static_cast<std::byte>(source >> (8 * i));
    }
    for (std::uint32_t octet : {0x88U, 0xbaU, number >> 24U, number >> 16U, number >> 8U, number}) {
        out->octets.push_back(static_cast<std::byte>(octet));
    }
    return out;
}
std::uint64_t identity(std::uint32_t number, std::uint64_t source = kStranger) {
    return frame_identity(numbered(number, source)->octets);
}

struct Sut {
    WireBook book{2, {{"process_bus", 0x88ba}, {"process_bus", 0x88b8}}};
    struct Match {
        FrameBuffer frame;
        std::int64_t send_time_ns;
    };
    std::vector<Match> matches;
    void announce(std::size_t process, std::vector<WireBook::Record> const& records, std::uint32_t incarnation = 0,
                  std::size_t channel = 0) {
        book.announced(process, incarnation, channel, records,
                       [&](FrameBuffer frame, std::int64_t time) { matches.push_back({std::move(frame), time}); });
    }
};

TEST(FrameIdentity, LeavesTheVlanTagOut) {
    EXPECT_EQ(frame_identity(frame({0x81, 0x00, 0x80, 0x05, 0x88, 0xba, 1, 2})),
              frame_identity(frame({0x88, 0xba, 1, 2})));
    EXPECT_NE(frame_identity(frame({0x88, 0xba, 1, 2})), frame_identity(frame({0x88, 0xba, 1, 3})));
}

TEST(WireBook, IsCompleteOnlyWhenEveryAnnouncedFrameIsHere) {
    Sut sut;
    sut.announce(0, {{1000, identity(7)}, {2000, identity(8)}});
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_TRUE(sut.book.complete(1));
    EXPECT_EQ(sut.book.missing(0), "2 frame(s) of ethertype 0x88ba on 'process_bus'");
    EXPECT_EQ(sut.book.arrived(0, numbered(8)).send_time_ns, 2000);
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_NE(sut.book.arrived(0, numbered(7)).due, nullptr);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, MatchesAFrameThatCameBeforeItsLedger) {
    Sut sut;
    FrameBuffer early = numbered(7);
    WireFrame const* const buffer = early.get();
    EXPECT_EQ(sut.book.arrived(0, std::move(early)).due, nullptr);
    sut.announce(0, {{1000, identity(7)}});
    ASSERT_EQ(sut.matches.size(), 1U);
    EXPECT_EQ(sut.matches[0].frame.get(), buffer);
    EXPECT_EQ(sut.matches[0].send_time_ns, 1000);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, KeepsIdenticalFramesApartByNumber) {
    Sut sut;
    sut.announce(0, {{1000, identity(7)}, {2000, identity(7)}});
    EXPECT_EQ(sut.book.arrived(0, numbered(7)).send_time_ns, 1000);
    EXPECT_FALSE(sut.book.complete(0));
    EXPECT_EQ(sut.book.arrived(0, numbered(7)).send_time_ns, 2000);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, AFrameOfAnotherEthertypeDoesNotMatch) {
    Sut sut;
    sut.announce(0, {{1000, identity(7)}});
    EXPECT_EQ(sut.book.arrived(1, numbered(7)).due, nullptr);
    EXPECT_FALSE(sut.book.complete(0));
}

TEST(WireBook, ForeignFramesAreEvictedOldestFirstAndCountedBySource) {
    Sut sut;
    std::vector<std::uint64_t> evicted;
    for (std::uint32_t i = 0; i < 1500; ++i) {
        if (auto const arrival = sut.book.arrived(0, numbered(i, kStranger + i % 2)); arrival.evicted != nullptr) {
            evicted.push_back(frame_identity(arrival.evicted->octets));
        }
    }
    ASSERT_EQ(evicted.size(), 1500U - WireBook::kMaxUnannounced);
    EXPECT_EQ(evicted.front(), identity(0));
    EXPECT_EQ(evicted[1], identity(1, kStranger + 1));
    EXPECT_EQ(sut.book.unannounced(0), WireBook::kMaxUnannounced);
    EXPECT_EQ(sut.book.foreign(0).total(), 1500U);
    EXPECT_EQ(sut.book.foreign(0).text(), "750 from 02:00:00:00:00:99, 750 from 02:00:00:00:00:9a");
}

TEST(WireBook, AFloodOnOneChannelTakesNoBufferOfAnother) {
    Sut sut;
    (void)sut.book.arrived(1, numbered(7));
    for (std::uint32_t i = 0; i < 2 * WireBook::kMaxUnannounced; ++i) {
        auto const arrival = sut.book.arrived(0, numbered(1000 + i));
        ASSERT_TRUE(arrival.evicted == nullptr || frame_identity(arrival.evicted->octets) != identity(7));
    }
    EXPECT_EQ(sut.book.unannounced(1), 1U);
    EXPECT_EQ(sut.book.foreign(1).total(), 1U);
}

TEST(WireBook, AFloodDoesNotDisplaceAFrameOfTheRunWhoseLedgerIsStillToCome) {
    constexpr std::uint64_t kBoard = 0x00a0de001122; // no address that the launcher gave: known by its frames
    Sut sut;
    sut.announce(0, {{1000, identity(1, kBoard)}});
    (void)sut.book.arrived(0, numbered(1, kBoard));
    (void)sut.book.arrived(0, numbered(2, kBoard));
    (void)sut.book.arrived(0, numbered(3, kRun));
    for (std::uint32_t i = 0; i < 5000; ++i) {
        (void)sut.book.arrived(0, numbered(100 + i, kStranger + i));
    }
    sut.announce(0, {{2000, identity(2, kBoard)}, {3000, identity(3, kRun)}});
    EXPECT_TRUE(sut.book.complete(0));
    EXPECT_EQ(sut.matches.size(), 2U);
    EXPECT_EQ(sut.book.foreign(0).total(), 5000U);
    EXPECT_THAT(sut.book.foreign(0).text(), testing::HasSubstr("from others")) << "the table of addresses is bounded";
}

TEST(WireBook, ForgetsWhatARestartedProcessHadAnnounced) {
    Sut sut;
    sut.announce(0, {{1000, identity(7)}});
    sut.announce(0, {}, 1);
    EXPECT_TRUE(sut.book.complete(0));
}

TEST(WireBook, DoesNotTakeTheLedgerOfAnEarlierIncarnation) {
    Sut sut;
    sut.announce(0, {}, 2);
    sut.announce(0, {{1000, identity(7)}}, 1);
    EXPECT_TRUE(sut.book.complete(0));
}

} // namespace
} // namespace gridspace::lockstep
