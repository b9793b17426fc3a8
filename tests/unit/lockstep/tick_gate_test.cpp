// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/tick_gate.hpp"

#include <gtest/gtest.h>

namespace gridspace::lockstep {
namespace {

// Members in the order of names: ev1 = bit 0, ev2 = bit 1, mcca = bit 2.
class TickGateTest : public ::testing::Test {
  protected:
    LedgerBook book{{"ev1", "ev2", "mcca", "sim"}, {"requests"}};
    TickGate sut{{"mcca", "sim", {"ev2", "ev1", "mcca"}, {"ev1", "ev2"}}, book};
    std::size_t ev1 = book.process_index("ev1");
    std::size_t ev2 = book.process_index("ev2");
    std::size_t sim = book.process_index("sim");
    std::vector<std::uint8_t> all{0b111};
};

TEST_F(TickGateTest, StartsOnlyWithTheClockTheAcknowledgementsAndTheSamples) {
    EXPECT_FALSE(sut.granted());
    sut.on_clock(0, all, false);
    EXPECT_FALSE(sut.granted());
    sut.on_ack(ev1, 0);
    book.announced(ev2, 0, "requests", 1);
    sut.on_ack(ev2, 0);
    EXPECT_FALSE(sut.granted());
    EXPECT_EQ(sut.awaiting(), "1 of 1 samples of 'requests' from ev2");
    book.arrived(ev2, 0, 0, 0, 1);
    ASSERT_TRUE(sut.granted());
    EXPECT_EQ(sut.granted()->tick, 0U);
    sut.done();
    EXPECT_FALSE(sut.granted());
}

TEST_F(TickGateTest, AcknowledgementsMayOvertakeTheClock) {
    sut.on_ack(ev1, 0);
    sut.on_ack(ev2, 0);
    EXPECT_FALSE(sut.granted());
    sut.on_clock(0, all, false);
    EXPECT_TRUE(sut.granted());
}

TEST_F(TickGateTest, DoesNotWaitForUpstreamMembersThatAreIdleInTheTick) {
    sut.on_clock(4, std::vector<std::uint8_t>{0b101}, false); // ev2 is idle
    sut.on_ack(ev1, 4);
    EXPECT_TRUE(sut.granted());
}

TEST_F(TickGateTest, OfALateOneTheTickBeforeIsEnough) {
    TickGate late{{"mcca", "sim", {"ev2", "ev1", "mcca"}, {"ev1", "ev2"}, {"ev2"}}, book};
    late.on_clock(4, all, false);
    late.on_ack(ev1, 4);
    EXPECT_TRUE(late.granted()); // ev2 was awaited in no tick before
    late.done();
    late.on_clock(5, all, false);
    late.on_ack(ev1, 5);
    EXPECT_FALSE(late.granted());
    EXPECT_EQ(late.awaiting(), "the acknowledgement of tick 4 by ev2");
    late.on_ack(ev2, 4);
    EXPECT_TRUE(late.granted());
    late.done();
    late.on_clock(6, std::vector<std::uint8_t>{0b011}, false); // it sleeps through that one
    late.on_clock(7, std::vector<std::uint8_t>{0b101}, false);
    late.on_ack(ev1, 7);
    EXPECT_EQ(late.awaiting(), "the acknowledgement of tick 6 by ev2");
    late.on_ack(ev2, 6);
    EXPECT_TRUE(late.granted());
}

TEST_F(TickGateTest, SleepsThroughTicksThatDoNotAwaitIt) {
    sut.on_clock(3, std::vector<std::uint8_t>{0b011}, false);
    sut.on_ack(ev1, 3);
    sut.on_ack(ev2, 3);
    EXPECT_FALSE(sut.granted());
    EXPECT_FALSE(sut.has_pending());
    EXPECT_EQ(sut.latest_tick(), 3U);
}

TEST_F(TickGateTest, MissesNothingOfTheTicksThatItSleptThrough) {
    sut.on_clock(3, std::vector<std::uint8_t>{0b001}, false); // ev1 works, this member does not
    sut.on_clock(9, std::vector<std::uint8_t>{0b100}, false); // now it does, and ev1 does not
    EXPECT_FALSE(sut.granted());
    EXPECT_EQ(sut.awaiting(), "the acknowledgement of tick 3 by ev1");
    sut.on_ack(ev1, 3);
    EXPECT_TRUE(sut.granted());
}

TEST_F(TickGateTest, WaitsForTheSimulatorsSamplesToo) {
    LedgerBook own{{"sim"}, {"bus_measurements"}};
    TickGate gate{{"ev1", "sim", {"ev1"}, {}}, own};
    own.announced(0, 0, "bus_measurements", 1);
    gate.on_clock(0, std::vector<std::uint8_t>{1}, true);
    EXPECT_FALSE(gate.granted());
    own.arrived(0, 0, 0, 0, 1);
    ASSERT_TRUE(gate.granted());
    EXPECT_TRUE(gate.granted()->final);
}

TEST_F(TickGateTest, NamesWhomItWaitsFor) {
    sut.on_clock(7, all, false);
    sut.on_ack(ev1, 7);
    EXPECT_EQ(sut.awaiting(), "the acknowledgement of tick 7 by ev2");
}

} // namespace
} // namespace gridspace::lockstep
