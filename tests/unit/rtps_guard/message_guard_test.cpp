// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/gate.hpp"
#include "tests/support/rtps_message.hpp"

#include <gmock/gmock.h>

namespace gridspace::rtps_guard {

static void PrintTo(Refusal refusal, std::ostream* out) {
    *out << (refusal == Refusal::none ? "admitted" : to_string(refusal));
}

namespace {

using namespace test;

Refusal refusal_of(Bytes message, Rules rules = {}) {
    return examine(message, rules).refusal;
}
constexpr std::uint32_t kWriter = 0x00000102, kReader = 0x00000107;
Bytes const kPayload{0, 1, 0, 0, 7, 0, 0, 0};
Bytes heartbeat(std::int64_t first, std::int64_t last) {
    return submessage(0x07, joined({entity(kReader), entity(kWriter), number(first), number(last), little(1, 4)}));
}
Bytes acknack(std::int64_t base, std::uint32_t bits, std::size_t words) {
    return submessage(0x06, joined({entity(kReader), entity(kWriter), number(base), little(bits, 4), Bytes(4 * words),
                                    little(1, 4)}));
}
Bytes gap(std::int64_t first, std::int64_t beyond) {
    return submessage(0x08, joined({entity(kReader), entity(kWriter), number(first), number(beyond), little(0, 4)}));
}
Bytes fragment(std::uint32_t first, std::uint16_t count, std::uint16_t size, std::uint32_t whole) {
    return submessage(0x16, joined({{0, 0, 28, 0},
                                    entity(kReader),
                                    entity(kWriter),
                                    number(1),
                                    little(first, 4),
                                    little(count, 2),
                                    little(size, 2),
                                    little(whole, 4),
                                    Bytes(8)}));
}

TEST(MessageGuard, AdmitsWhatParticipantsSend) {
    for (Bytes const& good :
         {message({announcement(1)}), message({data(0, kWriter, kPayload), kStatistics}),
          message({submessage(0x0e, guid_prefix(9)), heartbeat(1, 0), acknack(0, 0, 0), gap(3, 4)}),
          message({submessage(0x09, Bytes(8)), data(kReader, kWriter, kPayload), submessage(0x09, {}, 3)}),
          message({acknack(5, 256, 8)}), message({fragment(2, 1, 8, 16)}), message({submessage(0x01, {})}),
          message({submessage(0x81, {1, 2, 3, 4})})}) {
        EXPECT_EQ(refusal_of(good), Refusal::none);
    }
}

TEST(MessageGuard, KeepsStatisticsFromTheLibraryAndRefusesThemWhereTheyAreNotTheLast) {
    Bytes good = message({data(0, kWriter, kPayload), kStatistics});
    EXPECT_EQ(examine(good).octets, good.size() - kStatistics.size());
    EXPECT_EQ(deadly_datagram().size(), 92U);
    EXPECT_EQ(refusal_of(deadly_datagram()), Refusal::kind);
    EXPECT_EQ(refusal_of(message({submessage(0x80, Bytes(52))})), Refusal::kind);
}

TEST(MessageGuard, RefusesWhatIsNoMessage) {
    EXPECT_EQ(refusal_of({}), Refusal::not_rtps);
    EXPECT_EQ(refusal_of(Bytes(20)), Refusal::not_rtps);
    Bytes old = message({});
    old[4] = 3;
    EXPECT_EQ(refusal_of(old), Refusal::not_rtps);
    Bytes nobody = message({});
    std::fill(nobody.begin() + 8, nobody.end(), std::uint8_t{0});
    EXPECT_EQ(refusal_of(nobody), Refusal::not_rtps);
}

TEST(MessageGuard, RefusesEveryPrefixOfAMessageThatCutsASubmessage) {
    Bytes const whole = message({announcement(1), heartbeat(1, 4)});
    std::size_t const boundary = whole.size() - heartbeat(1, 4).size();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        if (size != 20 && size != boundary) {
            EXPECT_NE(refusal_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}), Refusal::none)
                << size << " of " << whole.size();
        }
    }
}

TEST(MessageGuard, RefusesNumbersThatContradictEachOtherOrTheOctetsThatAreThere) {
    for (Bytes const& bad : {data(0, kWriter, kPayload, 0),
                             data(0, kWriter, kPayload, -1),
                             data(0, kWriter, kPayload, INT64_MAX),
                             data(0, kWriter, kPayload, 1, 0x0d),
                             data(0, kWriter, {}),
                             heartbeat(0, 3),
                             heartbeat(5, 3),
                             heartbeat(1, INT64_MAX),
                             acknack(INT64_MAX, 0, 0),
                             acknack(1, 257, 8),
                             acknack(1, 64, 0),
                             gap(1, INT64_MAX / 4),
                             gap(0, 1),
                             fragment(0, 1, 8, 16),
                             fragment(4, 1, 8, 16),
                             fragment(1, 1, 8, UINT32_MAX),
                             fragment(1, 0, 8, 16),
                             fragment(1, 1, 0, 16),
                             submessage(0x09, Bytes(4)),
                             submessage(0x0e, Bytes(8))}) {
        EXPECT_EQ(refusal_of(message({bad})), Refusal::content) << int{bad[0]};
    }
    Bytes beyond = data(0, kWriter, kPayload);
    beyond[6] = 200; // octets to the inline QoS
    EXPECT_EQ(refusal_of(message({beyond})), Refusal::content);
}

TEST(MessageGuard, RefusesNumbersThatTheLibraryWouldWalkUpToForMinutes) {
    auto const past = [](std::uint32_t reader, std::uint32_t writer, std::int64_t first) {
        return message(
            {submessage(0x07, joined({entity(reader), entity(writer), number(first), number(first), little(1, 4)}))});
    };
    EXPECT_EQ(refusal_of(past(0x000003c7, 0x000003c2, 1 << 21)), Refusal::content);
    EXPECT_EQ(refusal_of(past(0x000003c7, 0x000003c2, 1 << 19)), Refusal::none);
    EXPECT_EQ(refusal_of(past(kReader, kWriter, 1 << 30)), Refusal::none);
    EXPECT_EQ(refusal_of(past(kReader, kWriter, std::int64_t{1} << 32)), Refusal::content);
}

TEST(MessageGuard, LetsAnotherParticipantOfTheProcessSpeakAndRefusesSecurityThatNobodyHas) {
    EXPECT_EQ(refusal_of(message({submessage(0x0c, Bytes(20)), heartbeat(1, 1)})), Refusal::content); // nobody
    EXPECT_EQ(refusal_of(message({submessage(0x0c, Bytes(20, 7)), heartbeat(1, 1)})), Refusal::none);
    EXPECT_EQ(refusal_of(message({submessage(0x30, Bytes(20))})), Refusal::kind);
}

TEST(MessageGuard, RefusesDiscoveryInFragmentsOrFromUsersWriters) {
    EXPECT_EQ(refusal_of(message({data(kParticipantReader, kWriter, kPayload)})), Refusal::content);
    EXPECT_EQ(refusal_of(message({data(kReader, kParticipantWriter, kPayload)})), Refusal::content);
    Bytes of_discovery = fragment(1, 1, 8, 16);
    std::ranges::copy(entity(kParticipantWriter), of_discovery.begin() + 12);
    EXPECT_EQ(refusal_of(message({of_discovery})), Refusal::content);
}

TEST(MessageGuard, RefusesDamagedParameters) {
    Bytes no_sentinel = announcement(1);
    no_sentinel.resize(no_sentinel.size() - 4);
    no_sentinel[2] = static_cast<std::uint8_t>(no_sentinel.size() - 4);
    EXPECT_EQ(refusal_of(message({no_sentinel})), Refusal::parameters);
    Bytes const endless = joined({little(UINT32_MAX, 4), {'a', 'b', 'c', 0}});
    Bytes const unended = joined({little(4, 4), {'a', 'b', 'c', 'd'}});
    for (Bytes const& bad :
         {parameter(0x0062, endless), parameter(0x0062, unended), parameter(0x0059, little(UINT32_MAX, 4)),
          parameter(0x0059, joined({little(1, 4), endless})), parameter(0x0029, little(7, 4)),
          parameter(0x002c, little(400, 4)), parameter(0x0050, Bytes(12)), Bytes{0x62, 0, 0xff, 0xff}}) {
        EXPECT_EQ(refusal_of(message({announcement(1, bad)})), Refusal::parameters);
    }
}

TEST(MessageGuard, RefusesWhoSpeaksForAnotherParticipantUnlessThereIsADiscoveryServer) {
    EXPECT_EQ(refusal_of(message({announcement(2)}, 1)), Refusal::identity);
    EXPECT_EQ(refusal_of(message({announcement(2)}, 1), {.speaks_for_itself = false}), Refusal::none);
    // "Participant 2 is gone", by its key alone (CVE-2023-50257).
    Bytes const key = joined(
        {parameter(0x0070, joined({guid_prefix(2), entity(0x000001c1)})), parameter(0x0071, {0, 0, 0, 3}), kSentinel});
    EXPECT_EQ(refusal_of(message({data(kParticipantReader, kParticipantWriter, key, 2, 3)}, 1)), Refusal::identity);
    EXPECT_EQ(refusal_of(message({data(kParticipantReader, kParticipantWriter, key, 2, 3)}, 2)), Refusal::none);
}

TEST(MessageGuard, TurnsTypeObjectsIntoPaddingAndNothingElse) {
    Bytes const before =
        message({announcement(1, joined({parameter(0x0072, Bytes(8, 7)), parameter(0x0062, text("x"))}))});
    Bytes after = before;
    ASSERT_EQ(examine(after).refusal, Refusal::none);
    auto const changed = std::ranges::mismatch(before, after);
    ASSERT_NE(changed.in1, before.end());
    EXPECT_EQ(*changed.in1, 0x72);
    EXPECT_EQ(*changed.in2, 0);
    EXPECT_TRUE(std::equal(changed.in1 + 1, before.end(), changed.in2 + 1));
}

/// How many octets the library is given of a datagram.
std::size_t admitted(Gate& sut, Bytes& datagram, std::int64_t now_ns) {
    std::size_t out = 0;
    sut.admit(datagram, now_ns, [&](auto message) { out += message.size(); });
    return out;
}

TEST(Gate, HearsOnlyWhoHasAnnouncedItself) {
    Gate sut;
    Bytes words = message({heartbeat(1, 1)}), hello = message({announcement(1)}), other = message({heartbeat(1, 1)}, 2);
    EXPECT_EQ(admitted(sut, words, 0), 0U);
    EXPECT_EQ(sut.refused(), 0U) << "it may only have come too early";
    EXPECT_EQ(admitted(sut, hello, 0), hello.size());
    EXPECT_EQ(admitted(sut, words, 0), words.size());
    EXPECT_EQ(admitted(sut, other, 0), 0U);
    Bytes deadly = deadly_datagram();
    EXPECT_EQ(admitted(sut, deadly, 0), 0U);
    EXPECT_EQ(sut.text(), "1 (a submessage that nobody sends here)");
}

TEST(Gate, SeveralParticipantsOfAProcessMayAnnounceThemselvesInOneMessage) {
    Gate sut{{}, 2};
    Bytes both = message({announcement(1), submessage(0x0c, joined({Bytes(8), guid_prefix(2)})), announcement(2)}, 1);
    EXPECT_EQ(admitted(sut, both, 0), both.size());
    Bytes words = message({heartbeat(1, 1)}, 2);
    EXPECT_EQ(admitted(sut, words, 0), words.size()) << "the second is known as well";
    Bytes for_another = message({announcement(1), announcement(2)}, 1);
    EXPECT_EQ(admitted(sut, for_another, 0), 0U) << "without saying that another one speaks";
}

TEST(Gate, AFloodOfInventedParticipantsHasABoundAndDisplacesNobody) {
    constexpr std::int64_t kSecond = 1'000'000'000;
    Gate sut{{}, 3};
    auto const hello = [&](std::uint8_t who, std::int64_t now_ns) {
        Bytes announced = message({announcement(who)}, who);
        return admitted(sut, announced, now_ns) > 0;
    };
    EXPECT_TRUE(hello(1, 0) && hello(2, 0) && hello(3, 0));
    for (int who = 4; who < 200; ++who) {
        EXPECT_FALSE(hello(static_cast<std::uint8_t>(who), kSecond));
    }
    EXPECT_EQ(sut.text(), "196 (one participant too many)");
    EXPECT_TRUE(hello(1, 50 * kSecond) && hello(2, 50 * kSecond)) << "who is heard stays";
    EXPECT_TRUE(hello(200, 70 * kSecond)) << "who has been silent for a minute makes room";
    EXPECT_FALSE(hello(201, 70 * kSecond));
}

} // namespace
} // namespace gridspace::rtps_guard
