// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/gate.hpp"
#include "tests/support/rtps_message.hpp"

#include <gmock/gmock.h>
#include <numeric>

namespace gridspace::rtps_guard {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kWriter = 0x00000102, kReader = 0x00000107;
constexpr std::uint16_t kSize = 8;
Bytes const kTime = submessage(0x09, {1, 0, 0, 0, 2, 0, 0, 0});
Bytes const kHeartbeat =
    submessage(0x07, joined({entity(kReader), entity(kWriter), number(1), number(1), little(1, 4)}));
Bytes const kQos = joined({parameter(0x0070, Bytes(16, 5)), kSentinel});

Bytes sample_of(std::uint32_t octets) {
    Bytes out(octets);
    std::iota(out.begin(), out.end(), std::uint8_t{0});
    out[1] = 1; // CDR_LE
    return out;
}
/// `count` fragments of `whole` from number `first` on.
Bytes fragments(Bytes const& whole, std::uint32_t first, std::uint16_t count = 1, std::int64_t sequence = 1,
                Bytes const& qos = {}) {
    auto const begin = whole.begin() + (first - 1) * kSize;
    auto const octets = std::min<std::ptrdiff_t>(count * kSize, whole.end() - begin);
    return submessage(0x16,
                      joined({{0, 0, 28, 0},
                              entity(kReader),
                              entity(kWriter),
                              number(sequence),
                              little(first, 4),
                              little(count, 2),
                              little(kSize, 2),
                              little(whole.size(), 4),
                              qos,
                              Bytes(begin, begin + octets)}),
                      qos.empty() ? 1 : 3);
}
Bytes whole_message(Bytes const& sample, std::int64_t sequence = 1, Bytes const& qos = {}) {
    Bytes out = message({kTime, data(kReader, kWriter, joined({qos, sample}), sequence, qos.empty() ? 5 : 7)});
    out[20 + kTime.size() + 2] = out[20 + kTime.size() + 3] = 0; // its length: to the end
    return out;
}

/// A gate with a participant 1 behind it, and what it has delivered.
class FragmentsOf : public testing::Test {
  protected:
    FragmentsOf() { (void)given(message({announcement(1)})); }
    std::vector<Bytes> given(Bytes datagram, std::int64_t now_ns = 0) {
        std::vector<Bytes> out;
        sut_.admit(datagram, now_ns, [&](auto octets) { out.emplace_back(octets.begin(), octets.end()); });
        return out;
    }
    Gate sut_;
};

TEST_F(FragmentsOf, ASampleAreGivenAsOneWhenTheLastHasCome) {
    Bytes const sample = sample_of(21);
    EXPECT_THAT(given(message({kTime, fragments(sample, 3)})), IsEmpty());
    EXPECT_THAT(given(message({kTime, fragments(sample, 1)})), IsEmpty());
    EXPECT_THAT(given(message({kTime, fragments(sample, 1)})), IsEmpty()) << "sent again";
    EXPECT_THAT(given(message({kTime, fragments(sample, 2)})), ElementsAre(whole_message(sample)));
    EXPECT_THAT(given(message({kTime, fragments(sample, 1, 3)})), ElementsAre(whole_message(sample))) << "all at once";
}

TEST_F(FragmentsOf, ASampleKeepTheInlineQosOfTheFirst) {
    Bytes const sample = sample_of(16);
    (void)given(message({kTime, fragments(sample, 1, 1, 1, kQos)}));
    EXPECT_THAT(given(message({kTime, fragments(sample, 2)})), ElementsAre(whole_message(sample, 1, kQos)));
}

TEST_F(FragmentsOf, ASampleKeepTheirPlaceAmongOtherSubmessages) {
    Bytes const first = sample_of(8), last = sample_of(16);
    EXPECT_THAT(given(message({kTime, kHeartbeat, fragments(first, 1), kHeartbeat, fragments(last, 1, 1, 2)})),
                ElementsAre(message({kTime, kHeartbeat}), whole_message(first), message({kTime, kHeartbeat})));
    EXPECT_THAT(given(message({kTime, fragments(last, 2, 1, 2)})), ElementsAre(whole_message(last, 2)));
}

TEST_F(FragmentsOf, ASampleMayNotContradictEachOther) {
    Bytes const sample = sample_of(24), shorter = sample_of(16);
    (void)given(message({kTime, fragments(sample, 1)}));
    EXPECT_THAT(given(message({kTime, fragments(shorter, 1, 2)})), IsEmpty()) << "the first one counts";
    EXPECT_THAT(given(message({kTime, fragments(sample, 2, 2)})), ElementsAre(whole_message(sample)));
}

TEST_F(FragmentsOf, ASampleOfWhichTheRestNeverComesAreForgotten) {
    Bytes const sample = sample_of(16);
    (void)given(message({kTime, fragments(sample, 1)}));
    (void)given(message({kTime, fragments(sample, 1, 1, 2)}), Fragments::kForgottenAfterNs + 1);
    EXPECT_THAT(given(message({kTime, fragments(sample, 2)}), Fragments::kForgottenAfterNs + 1), IsEmpty());
}

TEST(Fragments, OfManySamplesHaveABoundForEachParticipantAndForAll) {
    Fragments sut;
    constexpr std::uint32_t kWhole = 16U << 20U;
    auto const begin = [&](std::uint8_t who, std::int64_t sequence, std::uint32_t whole) {
        Bytes const one = submessage(0x16, joined({{0, 0, 28, 0},
                                                   entity(kReader),
                                                   entity(kWriter),
                                                   number(sequence),
                                                   little(1, 4),
                                                   little(1, 2),
                                                   little(kSize, 2),
                                                   little(whole, 4),
                                                   Bytes(kSize)}));
        Bytes datagram = message({one}, who);
        (void)sut.take(datagram, 0);
    };
    for (std::int64_t sequence = 1; sequence <= 100; ++sequence) {
        begin(1, sequence, 64);
    }
    EXPECT_EQ(sut.samples(), Fragments::kMaxSamplesOfOne);
    for (std::int64_t sequence = 1; sequence <= 5; ++sequence) {
        begin(2, sequence, kWhole);
    }
    EXPECT_EQ(sut.octets(), 64 * Fragments::kMaxSamplesOfOne + Fragments::kMaxOctetsOfOne);
    for (std::uint8_t who = 3; who < 20; ++who) {
        begin(who, 1, kWhole);
    }
    EXPECT_LE(sut.octets(), Fragments::kMaxOctets);
    EXPECT_GE(sut.samples(), Fragments::kMaxSamplesOfOne + 7) << "who holds little keeps it";
}

/// The first of two fragments of a sample, said in the name of another participant.
Bytes begun_as(std::uint32_t who, std::int64_t sequence) {
    return joined({submessage(0x0c, joined({{0, 0, 0, 0, 2, 3, 1, 15}, little(who, 4), Bytes(8)})),
                   fragments(sample_of(16), 1, 1, sequence)});
}

TEST(Fragments, InTheNameOfOthersCountForWhoSendsThem) {
    Fragments sut;
    for (std::uint32_t who = 0; who < 1000; ++who) {
        Bytes datagram = message({begun_as(who, 1)});
        (void)sut.take(datagram, 0);
    }
    EXPECT_EQ(sut.samples(), Fragments::kMaxSamplesOfOne);
}

TEST(Fragments, OfManyParticipantsHaveABoundTogether) {
    Fragments sut;
    for (int sender = 0; sender < 20; ++sender) {
        for (std::int64_t sequence = 1; sequence <= 50; ++sequence) {
            Bytes datagram = message({fragments(sample_of(16), 1, 1, sequence)}, static_cast<std::uint8_t>(sender));
            (void)sut.take(datagram, 0);
        }
    }
    EXPECT_EQ(sut.samples(), Fragments::kMaxSamples);
}

} // namespace
} // namespace gridspace::rtps_guard
