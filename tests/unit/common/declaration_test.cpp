// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/program/declaration.hpp"

#include <gmock/gmock.h>
#include <map>

namespace gridspace::program {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Values settings(std::map<std::string, std::vector<std::string>, std::less<>> values) {
    return [values = std::move(values)](std::string_view key) {
        auto const found = values.find(key);
        return found == values.end() ? std::vector<std::string>{} : found->second;
    };
}

std::vector<std::string> names(std::vector<Signal> const& signals) {
    std::vector<std::string> out;
    for (Signal const& signal : signals) {
        out.push_back(signal.name);
    }
    return out;
}

Declaration complete() {
    config::Key period{.key = "period_s", .doc = "how often", .kind = config::Key::Kind::fraction};
    period.default_text = "360";
    period.above = 0;
    config::Key mode{.key = "mode", .doc = "how", .kind = config::Key::Kind::word, .required = true};
    mode.words = {"fast", "slow"};
    config::Key several{.key = "evs", .doc = "which", .kind = config::Key::Kind::map};
    several.children = {period};
    return {
        .name = "ems",
        .description = "one \"line\"",
        .role = "ev_agent",
        .member = false,
        .daemon = true,
        .settings = {period, mode, several},
        .whole_steps = {"period_s"},
        .latency = "latency_us",
        .elements = {{"evs", "ev", "acts for", {{"bus", "bus"}}}},
        .reads =
            {{.topic = "{from}", .type = "Price", .triggers = true, .idl = "price.idl", .only = {{"bus", "{bus}"}}}},
        .writes = {{.topic = "plan", .type = "Plan", .optional = true}},
        .signals = {{"agent.{process}.cost", "EUR", 2}}};
}

TEST(Pattern, WithoutSettingsIsTheNameItself) {
    EXPECT_THAT(expand("requests", settings({})), ElementsAre("requests"));
    EXPECT_THAT(expand("agent.{process}.x", settings({{"process", {"p"}}})), ElementsAre("agent.p.x"));
}

TEST(Pattern, GivesANameForEachValueAndLeavesOutBracketsForOne) {
    std::string const pattern = "agent.{process}[.{ev|evs}].v_pu";
    EXPECT_THAT(expand(pattern, settings({{"process", {"p"}}, {"ev", {"A"}}})), ElementsAre("agent.p.v_pu"));
    EXPECT_THAT(expand(pattern, settings({{"process", {"p"}}, {"ev", {"A"}}, {"evs", {"B", "C"}}})),
                ElementsAre("agent.p.A.v_pu", "agent.p.B.v_pu", "agent.p.C.v_pu"));
    EXPECT_THAT(expand(pattern, settings({{"process", {"p"}}})), ElementsAre()); // what is not given has no signal
}

TEST(Pattern, OfBracesThatDoNotCloseIsLeftAsItIs) {
    EXPECT_THAT(expand("a.{ev", settings({{"ev", {"A"}}})), ElementsAre("a.{ev"));
    EXPECT_THAT(expand("a.]b[.{ev}", settings({{"ev", {"A", "B"}}})), ElementsAre("a.]b[.A", "a.]b[.B"));
    EXPECT_THAT(expand("{ev}", settings({{"ev", {"{ev}"}}})), ElementsAre("{ev}")); // and no value is expanded again
}

TEST(Pattern, SignalsOfOneElementStayTogether) {
    auto const all = settings({{"process", {"p"}}, {"evs", {"A", "B"}}});
    EXPECT_THAT(names(expand(std::vector<Signal>{{"{evs}.x"}, {"{evs}.y"}, {"total"}}, all)),
                ElementsAre("A.x", "A.y", "B.x", "B.y", "total"));
}

TEST(Declaration, ReadsBackFromItsOwnJson) {
    config::Diagnostics diagnostics;
    std::string const text = to_json(complete(), "1.2.3");
    auto const sut = from_json(text, "ems --describe", diagnostics);
    ASSERT_TRUE(sut) << diagnostics.render();
    EXPECT_EQ(to_json(*sut, "1.2.3"), text);
    EXPECT_EQ(sut->settings[2].children.front().above, 0.0);
    EXPECT_TRUE(sut->reads.front().triggers);
}

TEST(Declaration, OfTwoLinesIsEnough) {
    config::Diagnostics diagnostics;
    auto const sut = from_json(R"({"gridspace_program": 1, "name": "tiny"})", "tiny --describe", diagnostics);
    ASSERT_TRUE(sut) << diagnostics.render();
    EXPECT_EQ(sut->role, "member");
    EXPECT_TRUE(sut->member);
}

TEST(Declaration, MistakesAreNamedByLineAndColumn) {
    for (auto const& [text, expected] : std::vector<std::pair<std::string, std::string>>{
             {"{\"gridspace_program\": 2, \"name\": \"x\"}", "ems --describe:1:"},
             {"{\"gridspace_program\": 1}", "lacks the key 'name'"},
             {"{\"gridspace_program\": 1, \"name\": \"x\", \"topics\": []}", "unknown key 'topics'"},
             {"{\"gridspace_program\": 1, \"name\": \"x\",\n \"settings\": [{\"key\": \"a\", \"kind\": \"color\"}]}",
              "ems --describe:2:36: error: 'color' is no kind of setting"},
             {"{\"gridspace_program\": 1, \"name\": \"x\", \"settings\": [{\"key\": \"a\", \"kind\": \"word\"}]}",
              "the setting 'a' is a word, and no words are named"},
             {"{\"gridspace_program\": 1, \"name\": \"x\", \"reads\": [{\"topic\": \"a\"}]}", "lacks the key 'type'"},
             {R"({"gridspace_program": 1, "name": "x", "reads": [{"topic": "a", "type": "A", "only": ["b"]}]})",
              "`only` is a list"},
             {R"({"gridspace_program": 1, "name": "x", "writes": [{"topic": "a", "type": "A", "only": {"b": "c"}}]})",
              "`only` belongs to what a program reads"},
             {"hello", "ems --describe:1:1"},
         }) {
        config::Diagnostics diagnostics;
        EXPECT_FALSE(from_json(text, "ems --describe", diagnostics)) << text;
        EXPECT_THAT(diagnostics.render(), HasSubstr(expected)) << text;
    }
}

TEST(Declaration, KeysWithinKeysHaveAnEnd) {
    std::string text = R"({"key": "a", "kind": "any"})";
    for (int depth = 0; depth < 20; ++depth) {
        text = R"({"key": "a", "kind": "object", "keys": [)" + text + "]}";
    }
    config::Diagnostics diagnostics;
    EXPECT_FALSE(from_json(R"({"gridspace_program": 1, "name": "x", "settings": [)" + text + "]}", "x", diagnostics));
    EXPECT_THAT(diagnostics.render(), HasSubstr("more than eight deep"));
}

TEST(Keys, OfAnotherProgramAreCheckedAsThoseOfOurOwn) {
    config::Diagnostics diagnostics;
    config::Node node = config::Node::map();
    node.set("period_s", config::Node::scalar("-1"));
    node.set("mode", config::Node::scalar("fst"));
    node.set("evs", config::Node::map()).set("A", config::Node::map()).set("priod_s", config::Node::scalar("1"));
    config::read_fields(node, "processes.p", diagnostics,
                        [](config::Fields& f) { config::read_keys(f, complete().settings); });
    EXPECT_THAT(diagnostics.render(), HasSubstr("period_s is -1, which is out of range"));
    EXPECT_THAT(diagnostics.render(), HasSubstr("did you mean 'fast'?"));
    EXPECT_THAT(diagnostics.render(), HasSubstr("unknown key 'priod_s'"));
}

} // namespace
} // namespace gridspace::program
