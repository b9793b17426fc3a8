// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What our own programs say of themselves.
#include "agents/relay/relay_declaration.hpp"
#include "gateways/mu/mu_declaration.hpp"
#include "launcher/scenario/program.hpp"

#include <algorithm>
#include <gmock/gmock.h>

namespace gridspace::launcher {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<std::string> topics(std::vector<program::Topic> const& all) {
    std::vector<std::string> out;
    for (program::Topic const& topic : all) {
        out.push_back(topic.topic);
    }
    return out;
}

std::vector<std::string> names(std::vector<program::Signal> const& all) {
    std::vector<std::string> out;
    for (program::Signal const& signal : all) {
        out.push_back(signal.name);
    }
    return out;
}

TEST(OwnPrograms, DescribeThemselvesSoThatTheReaderOfForeignDescriptionsTakesIt) {
    std::size_t seen = 0;
    for (std::string const& name : program_names()) {
        program::Declaration const* const declaration = find_program(name)->declaration;
        if (declaration == nullptr) {
            EXPECT_EQ(name, "exec"); // which is no program
            continue;
        }
        ++seen;
        config::Diagnostics diagnostics;
        auto const read = program::from_json(program::to_json(*declaration, "1"), name, diagnostics);
        ASSERT_TRUE(read) << diagnostics.render();
        EXPECT_EQ(read->name, name);
        EXPECT_EQ(read->role, find_program(name)->default_role);
        EXPECT_EQ(topics(read->reads), topics(declaration->reads)) << name;
        EXPECT_EQ(names(read->signals), names(declaration->signals)) << name;
    }
    EXPECT_EQ(seen, 12U);
}

TEST(OwnPrograms, AMergingUnitWithVoltagesReadsTheSamplesOfABay) {
    gateways::MuConfig config;
    config.from.name = "bay";
    config.to.name = "SMV1";
    EXPECT_EQ(gateways::declaration(config, {}).reads.front().type, "LineCurrents");
    config.voltages.emplace();
    EXPECT_EQ(gateways::declaration(config, {}).reads.front().type, "BaySamples");
}

TEST(OwnPrograms, SignalsOfAClockAreThereInRealTimeOnly) {
    gateways::MuConfig config;
    config.ptp.emplace();
    EXPECT_THAT(names(gateways::declaration(config, {}).signals), Contains("clock.{process}.smp_synch"));
    EXPECT_THAT(names(gateways::declaration(config, {.real_time = false}).signals),
                Not(Contains("clock.{process}.smp_synch")));
}

TEST(OwnPrograms, ARelayHearsEachStreamOfItsBayOnceAndPublishesWhatItsFunctionsAreCalled) {
    relay::RelayConfig config;
    config.bay.functions = config::Node::map();
    config.bay.functions.set("PTOC1", config::Node::map());
    config.bay.currents.name = config.bay.voltages.name = "MU1";
    config.trip.name = "TRIP1";
    program::Declaration const out = relay::declaration(config, {});
    EXPECT_THAT(topics(out.reads), ElementsAre("MU1"));
    EXPECT_THAT(topics(out.writes), ElementsAre("TRIP1", "stream_statistics"));
    EXPECT_THAT(names(out.signals), Contains("relay.{process}.PTOC1.op"));
}

TEST(OwnPrograms, FirstLineRulesThatDoNotRunHaveNoSignals) {
    using OnFinding = gateways::FirstLineConfig::OnFinding;
    std::vector<gateways::GuardedStream> const streams{{"S", true, false}};
    EXPECT_THAT(gateways::first_line_signals({.on_finding = OnFinding::ignore}, streams), IsEmpty());
    EXPECT_THAT(gateways::first_line_signals({}, {}), IsEmpty());
    EXPECT_THAT(names(gateways::first_line_signals({}, streams)), Contains("first_line.{process}.S.refused"));
    EXPECT_THAT(names(gateways::first_line_signals({}, {{"S", true, true}})),
                Contains(::testing::StartsWith("first_line.{process}.S.authentication_")));
}

} // namespace
} // namespace gridspace::launcher
