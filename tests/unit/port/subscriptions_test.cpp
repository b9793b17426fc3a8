// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/subscriptions.hpp"

#include <gtest/gtest.h>

namespace gridspace::gateways {
namespace {

streams::Stream stream() {
    streams::Stream out;
    out.sv_id = "MU01";
    out.data_set = iec61850::data_set_92le();
    return out;
}

TEST(SvSubscriptionOfAStream, IsAliveBetweenItsSamplesHoweverSlowTheSimulationClockIs) {
    for (double const speed : {0.01, 0.1, 1.0, 20.0}) {
        iec61850::SvSubscriber sut{sv_subscription(stream(), speed)};
        double const period_ns = 1e9 / (4800 * speed);
        for (std::int64_t i = 0; i < 9600; ++i) {
            auto const now = static_cast<std::int64_t>(static_cast<double>(i) * period_ns);
            ASSERT_FALSE(sut.expire(now)) << "at speed " << speed;
            ASSERT_EQ(sut.receive(static_cast<std::uint16_t>(i % 4800), now).index, i);
        }
        EXPECT_EQ(sut.counters().lost, 0U);
        EXPECT_TRUE(sut.expire(static_cast<std::int64_t>(9610 * period_ns))) << "silence is noticed all the same";
    }
}

TEST(SvSubscriptionOfAStream, KnowsByTheSpeedHowManySamplesAGapHas) {
    for (double const speed : {0.1, 1.0, 20.0}) {
        iec61850::SvSubscriber sut{sv_subscription(stream(), speed)};
        double const period_ns = 1e9 / (4800 * speed);
        (void)sut.receive(0, 0);
        auto const back = sut.receive(3000, static_cast<std::int64_t>(3000 * period_ns));
        EXPECT_EQ(back.event, iec61850::SvEvent::lost);
        EXPECT_EQ(back.index, 3000);
    }
}

} // namespace
} // namespace gridspace::gateways
