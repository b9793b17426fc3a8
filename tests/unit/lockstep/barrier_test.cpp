// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/barrier.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace gridspace::lockstep {
namespace {

std::vector<std::string> missing(Barrier const& barrier) {
    std::vector<std::string> names;
    for (std::size_t const member : barrier.missing()) {
        names.push_back(barrier.member_name(member));
    }
    return names;
}

using Names = std::vector<std::string>;

class BarrierTest : public ::testing::Test {
  protected:
    Barrier sut{{{"mcca", {"ev1", "ev2"}}, {"ev2", {}}, {"ev1", {}}, {"recorder", {}}}, 16};
    std::size_t ev1 = sut.member_index("ev1");
    std::size_t ev2 = sut.member_index("ev2");
    std::size_t mcca = sut.member_index("mcca");
    std::size_t recorder = sut.member_index("recorder");

    void acknowledge_all(std::uint64_t tick, std::uint64_t next) {
        for (std::size_t i = 0; i < sut.size(); ++i) {
            (void)sut.on_ack(i, tick, next);
        }
    }
};

TEST_F(BarrierTest, OpensAndClosesWithEverybody) {
    sut.open(0, true);
    EXPECT_EQ(missing(sut), (Names{"ev1", "ev2", "mcca", "recorder"}));
    (void)sut.on_ack(ev1, 0, 1);
    (void)sut.on_ack(ev2, 0, 1);
    (void)sut.on_ack(mcca, 0, 1);
    EXPECT_FALSE(sut.complete());
    (void)sut.on_ack(recorder, 0, 1);
    EXPECT_TRUE(sut.complete());
}

TEST_F(BarrierTest, IdleMembersAreSkippedUntilTheTickTheyAskedFor) {
    sut.open(0, true);
    acknowledge_all(0, 5);
    for (std::uint64_t k = 1; k < 5; ++k) {
        sut.open(k, false);
        EXPECT_FALSE(sut.anybody_awaited()) << k;
        EXPECT_TRUE(sut.complete());
    }
    sut.open(5, false);
    EXPECT_EQ(missing(sut).size(), 4U);
}

TEST_F(BarrierTest, AMemberIsAwaitedWithWhatTriggersIt) {
    sut.open(0, true);
    acknowledge_all(0, 15);
    (void)sut.on_ack(ev1, 0, 1); // repeated: the first answer stands
    sut.open(1, false);
    EXPECT_FALSE(sut.anybody_awaited());

    Barrier chained{{{"a", {}}, {"b", {"a"}}, {"c", {"b"}}, {"d", {}}}, 16};
    chained.open(0, true);
    for (std::size_t i = 0; i < 4; ++i) {
        (void)chained.on_ack(i, 0, i == 0 ? 1 : 10);
    }
    chained.open(1, false);
    EXPECT_EQ(missing(chained), (Names{"a", "b", "c"}));
    EXPECT_EQ(chained.awaited_bits(), std::vector<std::uint8_t>{0b0111});
}

TEST_F(BarrierTest, WhoHearsALateOneIsAwaitedInTheTickAfterItHasSent) {
    Barrier pair{{{"client", {}, {"server"}}, {"server", {}, {"client"}}, {"tap", {"server"}}}, 16};
    std::size_t const client = pair.member_index("client"), server = pair.member_index("server"),
                      tap = pair.member_index("tap");
    pair.open(0, true);
    for (std::size_t const member : {client, server, tap}) {
        (void)pair.on_ack(member, 0, 10);
    }
    pair.open(1, false);
    EXPECT_FALSE(pair.anybody_awaited()); // nobody has sent anything
    pair.open(10, false);
    (void)pair.on_ack(client, 10, 30, 1);
    (void)pair.on_ack(server, 10, 30);
    (void)pair.on_ack(tap, 10, 30);
    pair.open(11, false);
    EXPECT_EQ(missing(pair), (Names{"server", "tap"})); // and who hears the server in the same tick
    (void)pair.on_ack(server, 11, 30, 1);
    (void)pair.on_ack(tap, 11, 30);
    pair.open(12, false);
    EXPECT_EQ(missing(pair), Names{"client"});
    (void)pair.on_ack(client, 12, 30);
    pair.open(13, false);
    EXPECT_FALSE(pair.anybody_awaited());
}

TEST_F(BarrierTest, NobodyLagsByMoreThanTheLimit) {
    sut.open(0, true);
    acknowledge_all(0, 1000);
    for (std::uint64_t k = 1; k < 16; ++k) {
        sut.open(k, false);
        EXPECT_FALSE(sut.anybody_awaited());
    }
    sut.open(16, false);
    EXPECT_EQ(missing(sut).size(), 4U);
}

TEST_F(BarrierTest, WhoCollectsFramesIsAwaitedBeforeThereAreTooManyInWhateverOrderAcknowledgementsCome) {
    for (bool const sender_first : {true, false}) {
        Barrier pair{{{.name = "idle", .triggered_by = {}},
                      {.name = "recorder", .triggered_by = {}, .collects_frames = true},
                      {.name = "sender", .triggered_by = {}}},
                     16};
        std::size_t const collector = pair.member_index("recorder"), sender = pair.member_index("sender");
        std::vector<std::uint64_t> awaited;
        for (std::uint64_t tick = 0; tick < 12; ++tick) {
            pair.open(tick, tick == 0);
            if (tick == 0) {
                (void)pair.on_ack(pair.member_index("idle"), 0, 1000);
            }
            auto const missed = missing(pair);
            bool const is_asked = std::find(missed.begin(), missed.end(), "recorder") != missed.end();
            if (is_asked) {
                awaited.push_back(tick);
            }
            if (is_asked && !sender_first) {
                (void)pair.on_ack(collector, tick, 1000);
            }
            (void)pair.on_ack(sender, tick, tick + 1, Barrier::kMostFrames / 4);
            if (is_asked && sender_first) {
                (void)pair.on_ack(collector, tick, 1000);
            }
            EXPECT_TRUE(pair.complete()); // who collects nothing is not asked
        }
        EXPECT_EQ(awaited, (std::vector<std::uint64_t>{0, 5, 10})) << sender_first;
    }
}

TEST_F(BarrierTest, ADroppedMemberIsNotAwaitedAndARejoinedOneIs) {
    sut.open(0, true);
    (void)sut.on_ack(ev1, 0, 1);
    (void)sut.on_ack(mcca, 0, 1);
    (void)sut.on_ack(recorder, 0, 1);
    EXPECT_FALSE(sut.complete());
    sut.drop(ev2);
    EXPECT_TRUE(sut.complete());
    sut.open(1, false);
    EXPECT_EQ(missing(sut), (Names{"ev1", "mcca", "recorder"}));
    sut.rejoin(ev2);
    acknowledge_all(1, 2);
    sut.open(2, false);
    EXPECT_EQ(missing(sut).size(), 4U);
}

TEST_F(BarrierTest, TheAcknowledgementOfADroppedMemberDoesNotStandForAnother) {
    sut.open(0, true);
    sut.drop(ev2);
    (void)sut.on_ack(ev2, 0, 1); // it was on its way
    (void)sut.on_ack(ev1, 0, 1);
    (void)sut.on_ack(mcca, 0, 1);
    EXPECT_EQ(missing(sut), (Names{"recorder"}));
    EXPECT_FALSE(sut.complete());
    (void)sut.on_ack(recorder, 0, 1);
    EXPECT_TRUE(sut.complete());
}

TEST_F(BarrierTest, WhoIsDroppedAndComesBackInATickIsNotCountedTwice) {
    sut.open(0, true);
    sut.drop(ev2);
    sut.rejoin(ev2);
    (void)sut.on_ack(ev2, 0, 1);
    EXPECT_FALSE(sut.complete());
    EXPECT_EQ(missing(sut), (Names{"ev1", "mcca", "recorder"}));
}

TEST_F(BarrierTest, LateAcknowledgementsOfAnOldTickDoNotCount) {
    sut.open(0, true);
    acknowledge_all(0, 1);
    sut.open(1, false);
    (void)sut.on_ack(ev1, 0, 1);
    EXPECT_EQ(missing(sut).size(), 4U);
    EXPECT_EQ(sut.last_ack(ev1), 0U);
}

TEST(Barrier, DoesNotTakeTheAcknowledgementOfATickToCome) {
    Barrier sut{{{"ev1", {}}, {"ev2", {}}}, 100};
    sut.open(0, true);
    EXPECT_FALSE(sut.on_ack(0, 10, 11));
    EXPECT_EQ(sut.missing().size(), 2U);
    EXPECT_TRUE(sut.on_ack(0, 0, 1));
    EXPECT_TRUE(sut.on_ack(1, 0, 1));
    EXPECT_TRUE(sut.complete());
}

} // namespace
} // namespace gridspace::lockstep
