// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/local_addresses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

TEST(LocalAddresses, NothingToWaitForIsThere) {
    EXPECT_TRUE(wait_for_addresses({}, {}).has_value());
}

TEST(LocalAddresses, AnAddressThatNoInterfaceHasIsNamedWhenPatienceIsOver) {
    auto const result = wait_for_addresses({"192.0.2.77"}, std::chrono::milliseconds{60}); // RFC 5737: nobody's
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, ExitCode::environment);
    EXPECT_THAT(result.error().message, testing::HasSubstr("no interface has the address 192.0.2.77"));
}

} // namespace
} // namespace gridspace::bus
