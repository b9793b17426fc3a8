// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_config.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

RelayLogicConfig read(char const* text, config::Diagnostics& diagnostics) {
    RelayLogicConfig out;
    auto const node = config::parse_yaml(text, config::make_source("relay.yaml", text), diagnostics);
    if (node) {
        config::read_fields(*node, "", diagnostics, [&](config::Fields& f) { describe(f, out); });
    }
    return out;
}

TEST(RelayConfig, ReadsThePublishedElement) {
    config::Diagnostics diagnostics;
    RelayLogicConfig const config =
        read("element: {kind: rms, window_cycles: 1, pickup_a: 30}\nseal_in: until_reset\n", diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    auto const sut = make_params(config, 4800, 60);
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->element.kind, ElementParams::Kind::rms);
    EXPECT_EQ(sut->element.window_samples, 80);
    EXPECT_EQ(sut->element.pickup_a, 30);
    EXPECT_TRUE(sut->seal_in);
    EXPECT_EQ(make_params(config, 4800, 50)->element.window_samples, 96);
}

TEST(RelayConfig, NamesMistakesWithTheirPlace) {
    config::Diagnostics diagnostics;
    static_cast<void>(read("element: {kind: rms, pickup_a: -1, slope_percent: 20}\nseal_in: forever\n", diagnostics));
    std::string const text = diagnostics.render();
    EXPECT_EQ(diagnostics.errors(), 3) << text;
    EXPECT_NE(text.find("relay.yaml:1:"), std::string::npos) << text;
    EXPECT_NE(text.find("the element 'rms' has no restraint"), std::string::npos) << text;
    EXPECT_NE(text.find("relay.yaml:2:"), std::string::npos) << text;
}

TEST(RelayConfig, RefusesWindowsThatAreNotWhole) {
    RelayLogicConfig config;
    config.pickup_a = 30;
    EXPECT_FALSE(make_params(config, 4000, 60));
    config.window_cycles = Rational(3, 4);
    auto const broken = make_params(config, 4800, 60);
    ASSERT_FALSE(broken);
    EXPECT_NE(broken.error().message.find("not a multiple of 1/2"), std::string::npos);
    config.kind = ElementParams::Kind::rms;
    EXPECT_TRUE(make_params(config, 4800, 60));
}

} // namespace
} // namespace gridspace::relay
