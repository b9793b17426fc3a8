// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/yaml.hpp"
#include "sim/network/network_config.hpp"

#include <gtest/gtest.h>
#include <string_view>

namespace gridspace::sim {

inline Network network_of(std::string_view text) {
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto out = read_network(*root, diagnostics);
    EXPECT_TRUE(out.has_value()) << diagnostics.render();
    return std::move(*out);
}

} // namespace gridspace::sim
