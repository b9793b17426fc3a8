// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/kernel_drops.hpp"

#include <gmock/gmock.h>
#include <sstream>

namespace gridspace::launcher {
namespace {

using ::testing::HasSubstr;

std::uint64_t drops(std::string const& softnet_stat) {
    std::istringstream text{softnet_stat};
    return kernel_drops(text);
}

TEST(KernelDrops, AreTheSecondNumberOfAllProcessors) {
    EXPECT_EQ(drops("24d48da1 0001a438 0000000f 00000000\n24c03968 00000010 00000012 00000000\n"), 0x1a438U + 0x10U);
}

TEST(KernelDrops, AreNoneWhereTheFileSaysNothing) {
    EXPECT_EQ(drops(""), 0U);
    EXPECT_EQ(drops("no numbers\n24d48da1\n"), 0U);
}

TEST(KernelDrops, AreSaidWithTheLimitAndWhatToDo) {
    EXPECT_FALSE(lost_in_kernel(0, 1000));
    auto const lost = lost_in_kernel(3, 1000);
    ASSERT_TRUE(lost);
    EXPECT_THAT(lost->message, HasSubstr("dropped 3 frames"));
    EXPECT_THAT(lost->message, HasSubstr("netdev_max_backlog (1000)"));
    EXPECT_THAT(lost->remedy, HasSubstr("netdev_max_backlog=20000"));
}

} // namespace
} // namespace gridspace::launcher
