// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/function_config.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

std::optional<FunctionSet> read(std::string const& text, config::Diagnostics& diagnostics,
                                std::uint8_t inputs = kCurrents) {
    auto const node = config::parse_yaml(text, config::make_source("relay.yaml", text), diagnostics);
    FunctionContext context;
    context.inputs = inputs;
    return node ? make_functions(*node, context, diagnostics) : std::nullopt;
}

TEST(FunctionConfig, MakesFunctionsInTheOrderInWhichTheyAskEachOther) {
    config::Diagnostics diagnostics;
    auto const set = read("RREC1: {initiated_by: [PTOC1], open_below_a: 10}\n"
                          "PTOC1: {pickup_a: 400, curve: iec_very_inverse, time_multiplier: 0.2, directional: RDIR1}\n"
                          "RDIR1: {polarisation: cross}\n",
                          diagnostics, kCurrents | kVoltages);
    ASSERT_TRUE(set) << diagnostics.render();
    ASSERT_EQ(set->functions().size(), 3U);
    EXPECT_EQ(set->functions()[0].name, "RDIR1");
    EXPECT_EQ(set->functions()[2].name, "RREC1");
    EXPECT_FALSE(set->functions()[2].trips);
    EXPECT_EQ(find_output(*set, "PTOC1.op")->function, 1U);
    EXPECT_FALSE(find_output(*set, "PTOC1.st")) << "neither op nor str";
}

TEST(FunctionConfig, AsksForValuesOnlyOfFunctionsThatMeasureSome) {
    config::Diagnostics diagnostics;
    auto const set = read("PTOC1: {pickup_a: 400, publish_values: true}\n"
                          "PIOC1: {pickup_a: 400, measures: residual, publish_values: true}\n"
                          "PDIS1: {reach_ohm: 4}\n",
                          diagnostics, kCurrents | kVoltages);
    ASSERT_TRUE(set) << diagnostics.render();
    EXPECT_TRUE(set->functions()[0].publishes && set->functions()[1].publishes);
    EXPECT_FALSE(set->functions()[2].publishes);
    EXPECT_EQ(set->functions()[0].function->quantities().size(), 3U);
    EXPECT_EQ(set->functions()[1].function->quantities()[0].name, "current_a");
    EXPECT_FALSE(read("RBRF1: {pickup_a: 5, publish_values: true}", diagnostics));
    EXPECT_NE(diagnostics.render().find("publish_values"), std::string::npos);
}

TEST(FunctionConfig, NamesWhatIsWrongWithItsPlace) {
    for (auto const& [text, expected] :
         {std::pair{"PTOX1: {pickup_a: 1}", "'PTOX1' is not the name of a function"},
          {"PTOC: {pickup_a: 1}", "'PTOC' is not the name of a function"},
          {"PTOC1: {delay_ms: 3}", "pickup_a"},
          {"PTOC1: {pickup_a: 5, dealy_ms: 3}", "dealy_ms"},
          {"PTOC1: {pickup_a: 5, curve: iec_very_inverse, delay_ms: 3}", "the time of a curve follows"},
          {"PTOC1: {pickup_a: 5, time_multiplier: 3}", "definite_time has no curve"},
          {"PTOC1: {pickup_a: 5, curve: iec_very_inverse, reset: dependent}", "no dependent reset time"},
          {"PTOC1: {pickup_a: 5, directional: RDIR1}", "there is no RDIR called 'RDIR1'"},
          {"PDIS1: {reach_ohm: 8}", "PDIS1 needs `voltages`"},
          {"PTUF1: {pickup_hz: 49}", "PTUF1 needs `voltages`"},
          {"{}", "names no function"}}) {
        config::Diagnostics diagnostics;
        EXPECT_FALSE(read(text, diagnostics)) << text;
        EXPECT_NE(diagnostics.render().find(expected), std::string::npos) << text << "\n" << diagnostics.render();
    }
}

TEST(FunctionConfig, TakesADirectionOfEachPhaseForCurrentsOfPhasesOnly) {
    for (std::string const function : {"PTOC1", "PIOC1"}) {
        for (std::string const measures : {"phases", "residual", "negative_sequence"}) {
            for (std::string const polarisation : {"cross", "positive_sequence", "zero_sequence"}) {
                config::Diagnostics diagnostics;
                auto const set = read(function + ": {pickup_a: 5, measures: " + measures +
                                          ", directional: RDIR1}\nRDIR1: {polarisation: " + polarisation + "}\n",
                                      diagnostics, kCurrents | kVoltages);
                bool const wrong = measures != "phases" && polarisation == "cross";
                EXPECT_EQ(set.has_value(), !wrong) << function << measures << polarisation;
                EXPECT_EQ(diagnostics.render().find("this current is of none") != std::string::npos, wrong);
            }
        }
    }
}

TEST(FunctionConfig, FindsTheClassInAName) {
    NodeClass of{};
    EXPECT_TRUE(class_in("Z2PDIS3", of));
    EXPECT_EQ(of, NodeClass::pdis);
    EXPECT_TRUE(class_in("PTOC12", of));
    for (char const* name : {"PDIS", "PDIS1x", "1", "", "DIS1", "12345"}) {
        EXPECT_FALSE(class_in(name, of)) << name;
    }
}

} // namespace
} // namespace gridspace::relay
