// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/ledger_book.hpp"

#include <gtest/gtest.h>

namespace gridspace::lockstep {
namespace {

using Arrival = LedgerBook::Arrival;

class LedgerBookTest : public ::testing::Test {
  protected:
    LedgerBook sut{{"ev1", "sim"}, {"requests", "bus_measurements"}};
    std::size_t ev1 = sut.process_index("ev1");
    std::size_t requests = 0; // the first reader
};

TEST_F(LedgerBookTest, IsCompleteWhenEverythingAnnouncedHasArrived) {
    EXPECT_TRUE(sut.complete(ev1));
    sut.announced(ev1, 0, "requests", 2);
    EXPECT_FALSE(sut.complete(ev1));
    EXPECT_EQ(sut.missing(ev1), "2 of 2 samples of 'requests' from ev1");
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1), Arrival::expected);
    EXPECT_FALSE(sut.complete(ev1));
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 2), Arrival::expected);
    EXPECT_TRUE(sut.complete(ev1));
}

TEST_F(LedgerBookTest, SamplesMayComeBeforeTheirLedger) {
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1), Arrival::expected);
    sut.announced(ev1, 0, "requests", 1);
    EXPECT_TRUE(sut.complete(ev1));
}

TEST_F(LedgerBookTest, SeveralWritersOfATopicAddUp) {
    sut.announced(ev1, 0, "requests", 3);
    sut.arrived(ev1, 0, requests, 7, 1);
    sut.arrived(ev1, 0, requests, 8, 1);
    EXPECT_FALSE(sut.complete(ev1));
    sut.arrived(ev1, 0, requests, 8, 2);
    EXPECT_TRUE(sut.complete(ev1));
}

TEST(LedgerBook, EveryReaderOfATopicMustHaveEverySample) {
    LedgerBook sut{{"mcca"}, {"decisions", "decisions"}};
    sut.announced(0, 0, "decisions", 1);
    EXPECT_EQ(sut.arrived(0, 0, 0, 0, 1), Arrival::expected);
    EXPECT_FALSE(sut.complete(0));
    EXPECT_EQ(sut.arrived(0, 0, 1, 0, 1), Arrival::expected);
    EXPECT_TRUE(sut.complete(0));
}

TEST_F(LedgerBookTest, TellsGapsAndRepetitions) {
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1), Arrival::expected);
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1), Arrival::repeated);
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 3), Arrival::gap);
}

TEST_F(LedgerBookTest, WhatWasWrittenAfterItsAcknowledgementIsLate) {
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1, 10), Arrival::expected);
    sut.announced(ev1, 0, "requests", 2);
    EXPECT_EQ(sut.acknowledged(ev1, 0, 10), "");
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 2, 10), Arrival::expected) << "announced, and still on its way";
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 3, 20), Arrival::expected) << "of a later tick";
    sut.announced(ev1, 0, "requests", 3);
    EXPECT_EQ(sut.acknowledged(ev1, 0, 20), "");
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 4, 20), Arrival::late);
}

TEST_F(LedgerBookTest, SamplesThatTheLedgerDoesNotCountAreNamedWithTheAcknowledgement) {
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 1, 10), Arrival::expected);
    EXPECT_EQ(sut.acknowledged(ev1, 0, 10), "1 samples of 'requests' have come, and its ledger says 0");
    EXPECT_EQ(sut.acknowledged(ev1, 1, 10), "") << "a new incarnation";
}

TEST_F(LedgerBookTest, WithTwoWritersWhatOvertookIsNotLate) {
    sut.announced(ev1, 0, "requests", 1);
    EXPECT_EQ(sut.acknowledged(ev1, 0, 10), "");
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 8, 1, 20), Arrival::expected);
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 7, 1, 10), Arrival::expected);
}

TEST_F(LedgerBookTest, ALostFirstSampleIsAGap) {
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 2), Arrival::gap);
}

TEST_F(LedgerBookTest, ARestartedProcessCountsFromZeroAndItsOldSelfIsIgnored) {
    sut.announced(ev1, 0, "requests", 5);
    sut.announced(ev1, 1, "requests", 1);
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 5), Arrival::repeated);
    EXPECT_FALSE(sut.complete(ev1));
    EXPECT_EQ(sut.arrived(ev1, 1, requests, 1, 1), Arrival::expected);
    EXPECT_TRUE(sut.complete(ev1));
}

TEST_F(LedgerBookTest, ALateJoinerTakesThePastAsHeld) {
    sut.baseline(ev1, 0, "requests", 10);
    EXPECT_TRUE(sut.complete(ev1));
    sut.announced(ev1, 0, "requests", 11);
    EXPECT_FALSE(sut.complete(ev1));
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 11), Arrival::expected);
    EXPECT_TRUE(sut.complete(ev1));
    EXPECT_EQ(sut.arrived(ev1, 0, requests, 0, 13), Arrival::gap);
}

TEST_F(LedgerBookTest, StrangersAreUnknown) {
    EXPECT_EQ(sut.process_index("ev9"), LedgerBook::kUnknown);
    sut.announced(ev1, 0, "decisions", 5); // not read here
    EXPECT_TRUE(sut.complete(ev1));
}

} // namespace
} // namespace gridspace::lockstep
