// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gtest/gtest.h>

/// `step_s: auto` of a scenario.
namespace gridspace::launcher {
namespace {

std::unique_ptr<Scenario> protection(std::vector<std::string> set) {
    config::Diagnostics diagnostics;
    set.emplace_back("simulation.step_s=auto");
    auto scenario =
        load_scenario(source_tree("configs/scenarios/protection.yaml"), {.set = std::move(set)}, diagnostics);
    EXPECT_NE(scenario, nullptr) << diagnostics.render();
    return scenario;
}

TEST(AutoStep, BecomesANumberForEverybodyWhoReadsTheScenario) {
    auto const sut = protection({});
    ASSERT_NE(sut, nullptr);
    // 200 steps of 60 Hz would be 1/12000 s, and a sample has whole steps: three.
    EXPECT_EQ(sut->simulation.step_s, Rational(1, 14400));
    EXPECT_EQ(sut->resolved.find("simulation")->find("step_s")->text, "1/14400");
}

TEST(AutoStep, IsAWholePartOfSampleTickAndDuration) {
    auto const sut = protection({"simulation.duration_s=0.7"});
    ASSERT_NE(sut, nullptr);
    Rational const step = sut->simulation.step_s;
    EXPECT_LE(step, Rational(1, 12000));
    for (Rational const whole : {Rational{1, 4800}, sut->tick_s(), Rational{7, 10}}) {
        EXPECT_TRUE((whole / step).is_whole()) << whole.to_string();
    }
}

} // namespace
} // namespace gridspace::launcher
