// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/door_channel.hpp"

#include <array>
#include <gtest/gtest.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

std::vector<std::byte> octets(std::size_t count, int value) {
    return std::vector<std::byte>(count, static_cast<std::byte>(value));
}

/// What the door finds; -1: nothing.
int read_one(UniqueFd const& door) {
    std::array<std::byte, 16> room{};
    return ::recv(door.get(), room.data(), room.size(), MSG_DONTWAIT) > 0 ? static_cast<int>(room[0]) : -1;
}

TEST(DoorChannel, AMessageIsThereAtItsTimeAndNotBefore) {
    DoorEnds ends = make_door_ends();
    DoorChannel sut{std::move(ends.ours), [](std::int64_t, std::span<std::byte const>) {}};
    sut.hand(100, octets(3, 1));
    sut.hand(100, octets(3, 2));
    sut.hand(250, octets(3, 3));
    EXPECT_EQ(sut.next_ns(0), 100);
    sut.exchange(99);
    EXPECT_EQ(read_one(ends.theirs), -1);
    sut.exchange(100);
    EXPECT_EQ(read_one(ends.theirs), 1);
    EXPECT_EQ(read_one(ends.theirs), 2);
    EXPECT_EQ(read_one(ends.theirs), -1) << "the third is of later";
    EXPECT_EQ(sut.next_ns(100), 250);
}

TEST(DoorChannel, WhatTheDoorSendsHasTheTimeAtWhichItIsTaken) {
    DoorEnds ends = make_door_ends();
    std::vector<std::pair<std::int64_t, std::size_t>> taken;
    DoorChannel sut{std::move(ends.ours), [&](std::int64_t now_ns, std::span<std::byte const> message) {
                        taken.emplace_back(now_ns, message.size());
                    }};
    sut.exchange(5);
    ASSERT_EQ(::send(ends.theirs.get(), "four", 4, 0), 4);
    ASSERT_EQ(::send(ends.theirs.get(), "more", 3, 0), 3);
    sut.exchange(7);
    sut.exchange(9);
    EXPECT_EQ(taken, (std::vector<std::pair<std::int64_t, std::size_t>>{{7, 4}, {7, 3}}));
}

TEST(DoorChannel, KeepsWhatDoesNotFitUntilTheDoorHasReadAndHoldsNoTimeUpForIt) {
    DoorEnds ends = make_door_ends();
    DoorChannel sut{std::move(ends.ours), [](std::int64_t, std::span<std::byte const>) {}};
    constexpr int kMany = 2000;
    for (int i = 0; i < kMany; ++i) {
        sut.hand(10, octets(4000, i % 100));
    }
    sut.exchange(10);
    EXPECT_EQ(sut.next_ns(10), std::nullopt) << "it waits for the door, not for a time";
    int read = 0;
    for (int value = 0; (value = read_one(ends.theirs)) >= 0; ++read) {
        EXPECT_EQ(value, read % 100);
        sut.exchange(10);
    }
    EXPECT_EQ(read, kMany);
}

} // namespace
} // namespace gridspace::timebox
