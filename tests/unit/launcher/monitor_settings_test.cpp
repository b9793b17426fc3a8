// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/monitor_settings.hpp"

#include "common/config/yaml.hpp"
#include "gateways/iec61850/frame.hpp"
#include "launcher/scenario/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

/// A process that sends and receives what it is told to, without a program behind it.
struct Device final : ProcessSettings {
    std::vector<WireUse> sent, received;
    [[nodiscard]] std::vector<WireUse> sends(Scenario const&, Process const&) const override { return sent; }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const&, Process const&) const override { return received; }
    [[nodiscard]] config::Node settings(Scenario const&, Process const&) const override { return config::Node::map(); }
};

Device& add(Scenario& s, std::string const& name) {
    Process process;
    process.name = {name, {}};
    auto device = std::make_unique<Device>();
    Device& out = *device;
    process.settings = std::move(device);
    s.processes.push_back(std::move(process));
    return out;
}

TEST(MonitoredRun, HasTheEndsOfStreamsAndNotWhoCapturesALink) {
    Scenario s;
    add(s, "mu").sent = {{"bus", iec61850::kSvEthertype, "SMV"}};
    add(s, "relay").received = {{"bus", iec61850::kSvEthertype, "SMV"}};
    add(s, "recorder").received = {{"bus", iec61850::kSvEthertype, "", true},
                                   {"bus", iec61850::kGooseEthertype, "", true}};

    config::Node const run = monitored_run(s, "..");

    std::vector<std::string> ends;
    for (config::Node const& wire : run.find("wires")->items) {
        ends.push_back(wire.find("process")->text + " " + wire.find("stream")->text);
    }
    EXPECT_THAT(ends, testing::ElementsAre("mu SMV", "relay SMV"));
}

TEST(MonitoredRun, HasWhatIsExpectedAsAReaderWouldSayIt) {
    Scenario s;
    std::string const text =
        "cb3_ms: {time_of: breaker.CB3.position == open, since: fault, unit: ms, between: [9, 21]}";
    config::Diagnostics diagnostics;
    s.expect = *config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);

    config::Node const run = monitored_run(s, "..");

    config::Node const& expectation = run.find("expectations")->items.at(0);
    EXPECT_EQ(expectation.find("rule")->text, "time of breaker.CB3.position == open, since fault");
    EXPECT_EQ(expectation.find("accepted")->text, "9 .. 21");
    EXPECT_EQ(expectation.find("unit")->text, "ms");
}

TEST(MonitoredRun, HasTheRelaysOfLinesAndBaysWithTheDeviceNumbersOfWhatTheyDo) {
    Scenario s;
    std::string const text =
        "processes:\n"
        "  mu: {program: gridspace-mu, from: BAY, to: SV}\n"
        "  line: {program: gridspace-relay, currents: {from: SV, to: W}, element: {pickup_a: 3}, trip: T}\n"
        "  bay: {program: gridspace-relay, inputs: {currents: SV}, trip: U, functions: {PDIS1: {}, PDIS2: {}, "
        "PTOC1: {}, RBRF1: {}}}\n"
        "simulation: {gateways: {G: {publish: {BAY: {ct: T1}}}}}\n";
    config::Diagnostics diagnostics;
    s.resolved = *config::parse_yaml(text, config::make_source("s.yaml", text), diagnostics);

    config::Node const run = monitored_run(s, "..");

    std::vector<std::string> said;
    for (config::Node const& relay : run.find("relays")->items) {
        std::string one = relay.find("name")->text + ":";
        for (char const* key : {"functions", "cts"}) {
            for (config::Node const& item : relay.find(key)->items) {
                one += " " + item.text;
            }
        }
        said.push_back(one);
    }
    EXPECT_THAT(said, testing::ElementsAre("line: 87L T1", "bay: 21 51 50BF T1"));
}

} // namespace
} // namespace gridspace::launcher
