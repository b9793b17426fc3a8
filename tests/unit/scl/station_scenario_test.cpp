// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "launcher/scl/station_report.hpp"
#include "launcher/scl/station_scenario.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string file() {
    std::ifstream stream{source_tree("configs/scl/small_station.scd"), std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

std::string with(std::string text, std::string const& what, std::string const& instead) {
    std::size_t const at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), instead);
}

scl::Station read(std::string const& text) {
    auto const document = scl::Document::parse(text, "s.scd");
    EXPECT_TRUE(document);
    return *scl::read_station(*document, 50);
}

StationOptions options() {
    StationOptions out;
    out.name = "station";
    out.network = "station_network.yaml";
    out.usual = {"CT1", "VT1"};
    return out;
}

/// The text at a path of keys; "" where there is nothing.
std::string at(config::Node const& root, std::initializer_list<char const*> path) {
    config::Node const* node = &root;
    for (char const* key : path) {
        node = node == nullptr ? nullptr : node->find(key);
    }
    return node == nullptr ? "" : node->text;
}

std::vector<std::string> keys(config::Node const* node) {
    std::vector<std::string> out;
    for (auto const& entry : node == nullptr ? std::vector<config::Node::Entry>{} : node->entries) {
        out.push_back(entry.key);
    }
    return out;
}

TEST(StationScenario, EveryIedWithStreamsIsAProcessAndInLockstepThoseThatAnswerEachOtherAreTwo) {
    auto const made = make_scenario(read(file()), options());
    ASSERT_TRUE(made) << describe(made.error());
    EXPECT_THAT(keys(made->root.find("processes")),
                ElementsAre("sim", "MU1", "PROT1", "PROT1_in", "BRK1", "BRK1_in", "recorder"));
    EXPECT_THAT(made->silent, ElementsAre("HMI1"));
    EXPECT_EQ(at(made->root, {"clock", "mode"}), "lockstep");

    StationOptions real = options();
    real.realtime = true;
    auto const in_real_time = make_scenario(read(file()), real);
    EXPECT_THAT(keys(in_real_time->root.find("processes")), ElementsAre("sim", "MU1", "PROT1", "BRK1", "recorder"));
    EXPECT_EQ(at(in_real_time->root, {"clock", "mode"}), "realtime");
}

TEST(StationScenario, PhasesAreMeasuredAndScaledAsTheFileSays) {
    auto const made = make_scenario(read(file()), options());
    config::Node const& mapping = *made->root.find("processes")->find("MU1")->find("mappings")->find("MU1_MSVCB01");
    EXPECT_EQ(at(mapping, {"from", "topic"}), "BAY_CT1_VT1");
    EXPECT_EQ(at(mapping, {"each"}), "samples");
    EXPECT_EQ(at(mapping, {"fields", "I01ATCTR1_AmpSv_instMag_i", "from"}), "samples.ia");
    EXPECT_EQ(at(mapping, {"fields", "I01ATCTR1_AmpSv_instMag_i", "scale"}), "1000");
    EXPECT_EQ(at(mapping, {"fields", "U01CTVTR3_VolSv_instMag_i", "from"}), "samples.vc");
    EXPECT_EQ(at(mapping, {"fields", "U01CTVTR3_VolSv_instMag_i", "scale"}), "100");
    EXPECT_EQ(at(mapping, {"fields", "I01NTCTR4_AmpSv_instMag_i", "value"}), "0") << "nobody measures the neutral";
    EXPECT_EQ(at(mapping, {"fields", "I01NTCTR4_AmpSv_q", "value"}), "derived");
    EXPECT_EQ(at(mapping, {"fields", "I01ATCTR1_AmpSv_q", "value"}), "good");
    EXPECT_EQ(at(made->root, {"simulation", "sampling", "rate_hz"}), "4000");
}

TEST(StationScenario, GooseBeginsWithAClosedBreakerAndNoTrip) {
    auto const made = make_scenario(read(file()), options());
    config::Node const& processes = *made->root.find("processes");
    EXPECT_EQ(at(processes, {"BRK1", "mappings", "BRK1_Position", "fields", "XCBR1_Pos_stVal", "value"}), "closed");
    EXPECT_EQ(at(processes, {"PROT1", "mappings", "PROT1_Trip", "fields", "PTRC1_Tr_general", "value"}), "false");
}

TEST(StationScenario, MeasuringPointsAreByIed) {
    StationOptions mapped = options();
    mapped.points["MU1"] = {"CT7", "VT8"};
    auto const made = make_scenario(read(file()), mapped);
    EXPECT_EQ(at(made->root, {"simulation", "gateways", "station", "publish", "BAY_CT7_VT8", "ct"}), "CT7");
    mapped.points["MU9"] = {"CT7", "VT8"};
    auto const refused = make_scenario(read(file()), mapped);
    ASSERT_FALSE(refused);
    EXPECT_THAT(describe(refused.error()), HasSubstr("there is no IED 'MU9' in the file"));
}

TEST(StationScenario, OnlyTheNamedIedsArePlayedAndWhatTheyHearOfOthersStaysDeclared) {
    StationOptions one = options();
    one.ieds = {"BRK1"};
    auto const made = make_scenario(read(file()), one);
    ASSERT_TRUE(made);
    EXPECT_THAT(keys(made->root.find("processes")), ElementsAre("sim", "BRK1", "BRK1_in", "recorder"));
    EXPECT_THAT(keys(made->root.find("streams")), ElementsAre("PROT1_Trip", "BRK1_Position"));
    EXPECT_EQ(made->root.find("expect"), nullptr) << "nobody here sends what it hears";
    one.ieds = {"HMI1"};
    auto const nothing = make_scenario(read(file()), one);
    ASSERT_FALSE(nothing);
    EXPECT_THAT(nothing.error().message, HasSubstr("nothing of the file can be played"));
}

TEST(StationScenario, RatesThatDoNotFallOnOneStepAreHeldBackInLockstepOnly) {
    std::string const odd =
        with(file(), R"(smpRate="80" nofASDU="2")", R"(smpRate="12799" smpMod="SmpPerSec" nofASDU="1")");
    std::string two = odd;
    // a second merging unit with the usual rate, so that both cannot be on one step
    std::size_t const from = file().find(R"(<IED name="MU1")"), until = file().find("</IED>", from) + 6;
    std::string second = file().substr(from, until - from);
    second.replace(second.find("MU1"), 3, "MU2");
    second.replace(second.find("MU1_MSVCB01"), 11, "MU2_MSVCB01");
    two.insert(two.find(R"(<IED name="PROT1")"), second);
    std::size_t const address = file().find(R"(<ConnectedAP iedName="MU1")"),
                      end = file().find("</ConnectedAP>", address) + 14;
    std::string connected = file().substr(address, end - address);
    connected.replace(connected.find("MU1"), 3, "MU2");
    connected.replace(connected.find("00-11"), 5, "00-12");
    connected.replace(connected.find("4011"), 4, "4012");
    two.insert(two.find(R"(<ConnectedAP iedName="PROT1")"), connected);
    auto const made = make_scenario(read(two), options());
    ASSERT_TRUE(made);
    ASSERT_EQ(made->findings.size(), 1U);
    EXPECT_THAT(made->findings[0].text, HasSubstr("do not fall on the simulator's steps"));
    StationOptions real = options();
    real.realtime = true;
    EXPECT_TRUE(make_scenario(read(two), real)->findings.empty());
}

TEST(StationReport, SaysInTextAndJsonWhatWasTakenAndWhatNot) {
    auto const station = read(file());
    auto const made = make_scenario(station, options());
    std::string const text = report_text(station, *made);
    EXPECT_THAT(text,
                testing::AllOf(HasSubstr("IEDs played (3 of 4)"),
                               HasSubstr("PROT1_Trip: goose 01:0C:CD:01:00:21 APPID 0x8021 confRev 10001: constants"),
                               HasSubstr("subscriptions (3 of 5 ExtRefs; 2 with LGOS or LSVS)"),
                               HasSubstr("left out (2)"), HasSubstr("'spare' is bound to nothing")));
    auto const json = nlohmann::json::parse(report_json(station, *made));
    EXPECT_EQ(json["ieds"].size(), 3U);
    EXPECT_EQ(json["subscriptions"][0]["supervisor"], "LD0/LSVS1");
    EXPECT_EQ(json["findings"].size(), station.import.findings.size());
    EXPECT_EQ(json["not_played"][0], "HMI1");
}

} // namespace
} // namespace gridspace::launcher
