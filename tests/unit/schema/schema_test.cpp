// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/key.hpp"
#include "common/source_tree.hpp"
#include "launcher/schema/schema_definitions.hpp"
#include "launcher/schema/schema_pages.hpp"

#include <fstream>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

std::string committed(std::string const& file) {
    std::ifstream stream{source_tree(file)};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

constexpr char const* kHowTo = "after a change of configuration keys: gridspace schema --write .";

TEST(Schema, TheCommittedSchemaOfScenariosIsCurrent) {
    EXPECT_TRUE(committed("configs/schema/scenario.schema.json") == scenario_schema()) << kHowTo;
}
TEST(Schema, TheCommittedSchemaOfNetworksIsCurrent) {
    EXPECT_TRUE(committed("configs/schema/network.schema.json") == network_schema()) << kHowTo;
}
TEST(Schema, TheCommittedSchemaOfRoutersIsCurrent) {
    EXPECT_TRUE(committed("configs/schema/router.schema.json") == router_schema()) << kHowTo;
}
TEST(Schema, TheCommittedSchemaOfStudiesIsCurrent) {
    EXPECT_TRUE(committed("configs/schema/study.schema.json") == study_schema()) << kHowTo;
    EXPECT_TRUE(committed("configs/schema/certify.schema.json") == certify_schema()) << kHowTo;
}
TEST(Schema, TheCommittedReferencePageIsCurrent) {
    EXPECT_TRUE(committed("docs/reference/config.md") == config_page()) << kHowTo;
}

TEST(Schema, TheCommittedTableOfActionsIsTheRegistry) {
    EXPECT_TRUE(committed("docs/reference/actions.md") == actions_page()) << kHowTo;
}

TEST(Schema, AKeyHasTheBoundsAndTheDefaultOfItsDescription) {
    double value = 15;
    auto const keys = config::keys_of([&](config::Fields& f) {
        f.number("rated_current_a", value, {.doc = "cap", .above = 0});
        f.object("rules", {.doc = "nested"},
                 [&](config::Fields& r) { r.number("factor", value, {.required = true, .min = 0, .max = 1}); });
    });
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].default_text, "15");
    EXPECT_EQ(keys[0].above, 0);
    EXPECT_FALSE(keys[0].min.has_value());
    ASSERT_EQ(keys[1].children.size(), 1u);
    EXPECT_TRUE(keys[1].children[0].required);
    EXPECT_EQ(keys[1].children[0].max, 1);
}

TEST(SchemaDefinitions, WhatRepeatsIsSaidOnceAndMeansTheSame) {
    std::string const part = R"({"description":"how far it is from here","anyOf":[{"type":"number"},{"type":"null"}]})";
    std::string const other =
        R"({"description":"how far it is from there","anyOf":[{"type":"number"},{"type":"null"}]})";
    std::string sut = with_definitions(R"({"properties":{"a":)" + part + R"(,"b":{"properties":{"a":)" + part +
                                       R"(}},"c":)" + other + "}}");
    std::erase_if(sut, [](char c) { return c == ' ' || c == '\n'; });
    EXPECT_EQ(sut, R"({"properties":{"a":{"$ref":"#/$defs/a"},"b":{"properties":{"a":{"$ref":"#/$defs/a"}}},"c":)"
                   R"({"description":"howfaritisfromthere","anyOf":[{"type":"number"},{"type":"null"}]}},"$defs":)"
                   R"({"a":{"description":"howfaritisfromhere","anyOf":[{"type":"number"},{"type":"null"}]}}})");
}

} // namespace
} // namespace gridspace::launcher
