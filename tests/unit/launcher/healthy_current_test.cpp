// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What is said about a relay that picks up before anything has happened.
#include "common/source_tree.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;

std::string said_with(std::vector<std::string> settings) {
    config::Diagnostics diagnostics;
    LoadOptions options;
    for (std::string const& setting : settings) {
        options.set.push_back("processes.relay2." + setting);
    }
    (void)load_scenario(source_tree("configs/scenarios/protection_lockstep.yaml"), options, diagnostics);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return diagnostics.render();
}

TEST(HealthyCurrent, IsNothingToSayAboutARelayWithTheRightPolarity) {
    EXPECT_EQ(said_with({}), "");
}

TEST(HealthyCurrent, IsWarnedOfWhenThePolarityIsToldWrongly) {
    std::string const said = said_with(
        {"positive={from: from_to, to: into_line}", "element={kind: phasor, pickup_a: 20, slope_percent: 30}"});
    EXPECT_THAT(said, HasSubstr("warning: relay 'relay2' would trip on the healthy network"));
    EXPECT_THAT(said, HasSubstr("is the direction right"));
}

TEST(HealthyCurrent, IsWarnedOfWhenBothCurrentsAreOfOneEnd) {
    EXPECT_THAT(said_with({"currents.to=SMV21"}), HasSubstr("same"));
}

} // namespace
} // namespace gridspace::launcher
