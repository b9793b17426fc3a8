// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/heartbeat_brake.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace gridspace::bus {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kPublications = 0x03, kSubscriptions = 0x04, kBuiltin = 0xc2, kOfAUser = 0x02;

/// RTPS header, HEARTBEAT of a writer, and the vendor's submessage at the end.
std::vector<std::uint8_t> heartbeat(std::uint8_t writer = kPublications, std::uint8_t kind = kBuiltin,
                                    std::uint8_t flags = 0x01, std::uint8_t last_number = 7) {
    std::vector<std::uint8_t> out(20, 0);
    std::vector<std::uint8_t> const submessage{0x07, flags, 28, 0, 0, 0, 0, 0, 0, 0, writer, kind};
    out.insert(out.end(), submessage.begin(), submessage.end());
    out.resize(20 + 32, 0);
    out[44] = last_number; // the low half, little-endian
    out.insert(out.end(), {0x80, 0x01, 0, 0});
    return out;
}

class ABrake : public ::testing::Test {
  protected:
    bool lets_pass(std::vector<std::uint8_t> const& message, std::size_t destinations) {
        return !HeartbeatBrake::concerns(message) || sut_.lets_pass(message, destinations, now_);
    }
    HeartbeatBrake sut_;
    HeartbeatBrake::Clock::time_point now_{1h};
};

TEST_F(ABrake, LetsOneOfManyHeartbeatsPassThatGoToHundreds) {
    EXPECT_TRUE(lets_pass(heartbeat(), 132));
    now_ += 499ms;
    EXPECT_FALSE(lets_pass(heartbeat(), 132)) << "5 ms for each beyond 32";
    now_ += 1ms;
    EXPECT_TRUE(lets_pass(heartbeat(), 132));
    now_ += 499ms;
    EXPECT_FALSE(lets_pass(heartbeat(), 132)) << "counted from the last that passed";
}

TEST_F(ABrake, NeverHoldsTheOneThatComesEachSecond) {
    EXPECT_TRUE(lets_pass(heartbeat(), 5000));
    now_ += 1s;
    EXPECT_TRUE(lets_pass(heartbeat(), 5000));
}

TEST_F(ABrake, IsOffForFewDestinations) {
    EXPECT_TRUE(lets_pass(heartbeat(), 32));
    EXPECT_TRUE(lets_pass(heartbeat(), 32));
}

TEST_F(ABrake, HasAPauseForEachWriter) {
    EXPECT_TRUE(lets_pass(heartbeat(kPublications), 200));
    EXPECT_TRUE(lets_pass(heartbeat(kSubscriptions), 200));
    EXPECT_FALSE(lets_pass(heartbeat(kPublications), 200));
}

TEST_F(ABrake, HoldsThoseOfAWriterThatHasWrittenNothing) {
    auto const empty = heartbeat(kPublications, kOfAUser, 0x01, 0);
    EXPECT_TRUE(lets_pass(empty, 1)) << "to a group";
    now_ += 100ms;
    EXPECT_FALSE(lets_pass(empty, 1));
    EXPECT_TRUE(lets_pass(heartbeat(kPublications, kOfAUser), 1)) << "now it has";
    now_ += 800ms;
    EXPECT_TRUE(lets_pass(empty, 1));
}

TEST_F(ABrake, LetsEverythingElsePass) {
    auto directed = heartbeat();
    std::vector<std::uint8_t> const info_dst{0x0e, 0x01, 12, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    directed.insert(directed.begin() + 20, info_dst.begin(), info_dst.end());
    auto with_data = heartbeat();
    with_data[52] = 0x15;
    auto cut = heartbeat();
    cut.resize(51);
    constexpr std::uint8_t kLiveliness = 0x05;
    for (int i = 0; i < 2; ++i) {
        EXPECT_TRUE(lets_pass(heartbeat(kPublications, kOfAUser), 200)) << "of a writer that has written";
        EXPECT_TRUE(lets_pass(heartbeat(kPublications, kBuiltin, kLiveliness), 200));
        EXPECT_TRUE(lets_pass(directed, 200));
        EXPECT_TRUE(lets_pass(with_data, 200));
        EXPECT_TRUE(lets_pass(cut, 200));
    }
}

} // namespace
} // namespace gridspace::bus
