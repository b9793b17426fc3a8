// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "sim/network/network_config.hpp"

#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

TEST(ShippedNetworks, AllRead) {
    int count = 0;
    for (auto const& file : std::filesystem::directory_iterator{source_tree("configs/networks")}) {
        if (file.path().extension() == ".yaml" || file.path().extension() == ".m") {
            config::Diagnostics diagnostics;
            EXPECT_TRUE(load_network(file.path(), diagnostics).has_value()) << diagnostics.render();
            ++count;
        }
    }
    EXPECT_GE(count, 2);
}

} // namespace
} // namespace gridspace::sim
