// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"

#include "common/config/merge.hpp"

#include <gmock/gmock.h>

namespace gridspace::config {
namespace {

using testing::HasSubstr;

std::optional<Node> parse(std::string_view text, Diagnostics& diagnostics) {
    return parse_yaml(text, make_source("t.yaml", text), diagnostics);
}

TEST(Yaml, KeepsTheOrderAndThePlaceOfEverything) {
    Diagnostics diagnostics;
    auto const root = parse("b: 1\na:\n  - x\n  - {k: \"30\"}\n", diagnostics);
    ASSERT_TRUE(root.has_value());
    EXPECT_EQ(root->entries[0].key, "b");
    Node const& list = root->entries[1].value;
    EXPECT_EQ(list.items[0].where.to_string(), "t.yaml:3:5");
    Node const* quoted = list.items[1].find("k");
    ASSERT_NE(quoted, nullptr);
    EXPECT_TRUE(quoted->quoted);
    EXPECT_EQ(quoted->where.column, 9);
}

TEST(Yaml, DuplicateKeysAreErrorsAtTheSecondOne) {
    Diagnostics diagnostics;
    (void)parse("a: 1\nb: 2\na: 3\n", diagnostics);
    EXPECT_EQ(diagnostics.render(), "t.yaml:3:1: error: duplicate key 'a'\n"
                                    "   3 | a: 3\n"
                                    "     | ^ first given at t.yaml:1:1\n"
                                    "1 error.");
}

TEST(Yaml, SyntaxErrorsSayWhere) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse("a: [1, 2\nb: 3\n", diagnostics).has_value());
    ASSERT_EQ(diagnostics.errors(), 1);
    EXPECT_EQ(diagnostics.sorted()[0].where.line, 2);
}

TEST(Yaml, ASecondDocumentIsAnError) {
    Diagnostics diagnostics;
    (void)parse("a: 1\n---\na: 2\n", diagnostics);
    EXPECT_EQ(diagnostics.errors(), 1);
}

TEST(Yaml, AnchorsWorkAndAliasBombsStop) {
    Diagnostics diagnostics;
    auto const root = parse("a: &x {k: 1}\nb: *x\n", diagnostics);
    ASSERT_TRUE(root && diagnostics.ok());
    EXPECT_EQ(root->find("b")->find("k")->text, "1");

    std::string bomb = "l0: &l0 [x,x,x,x,x,x,x,x,x,x]\n";
    for (int i = 1; i < 9; ++i) { // ten to the ninth values
        std::string const below = "*l" + std::to_string(i - 1);
        bomb += "l" + std::to_string(i) + ": &l" + std::to_string(i) + " [";
        for (int k = 0; k < 10; ++k) {
            bomb += (k == 0 ? "" : ",") + below;
        }
        bomb += "]\n";
    }
    Diagnostics bombed;
    EXPECT_FALSE(parse(bomb, bombed).has_value());
    EXPECT_EQ(bombed.errors(), 1);
}

TEST(Yaml, DeepNestingIsRefused) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse(std::string(200, '['), diagnostics).has_value());
    EXPECT_EQ(diagnostics.errors(), 1);
}

/// The one error of a text that costs too much.
std::string refusal(std::string const& text) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse(text, diagnostics).has_value());
    EXPECT_EQ(diagnostics.errors(), 1);
    return diagnostics.render();
}

std::string repeated(std::string const& text, std::size_t times) {
    std::string out;
    for (std::size_t i = 0; i < times; ++i) {
        out += text;
    }
    return out;
}

TEST(Yaml, EachLimitIsNamedWhereItIsReached) {
    std::string nested; // each value under sixty anchors
    for (int i = 0; i < 2000; ++i) {
        nested += "- " + repeated("&a [", 60) + "x" + std::string(60, ']') + "\n";
    }
    EXPECT_THAT(refusal(nested), HasSubstr("anchors and aliases stand for more than 100000 values"));
    EXPECT_THAT(refusal(repeated("- a\n", 500'001)), HasSubstr("more than 500000 values"));
    EXPECT_THAT(refusal("a: " + std::string(1'000'000, '[')), HasSubstr("nested deeper than 64 levels"));
    EXPECT_THAT(refusal("a: [" + std::string(1'000'000, ',')), HasSubstr("line 1 has more than 400000 brackets"));
}

TEST(Yaml, AFileThatIsTooLongIsNotReadToItsEnd) {
    Diagnostics diagnostics;
    EXPECT_FALSE(load_yaml("/dev/zero", diagnostics).has_value());
    EXPECT_THAT(diagnostics.render(), HasSubstr("the file has more than 16777216 octets"));
}

TEST(Yaml, ManyKeysAreNotSearchedFromTheFirstOnForEach) { // with a search it takes minutes
    std::string text;
    for (int i = 0; i < 200'000; ++i) {
        text += "k" + std::to_string(i) + ": 1\n";
    }
    Diagnostics diagnostics;
    auto const root = parse(text, diagnostics);
    ASSERT_TRUE(root && diagnostics.ok());
    Node merged = *root;
    merge(merged, *root);
    EXPECT_EQ(merged.entries.size(), 200'000U);
}

TEST(Yaml, OfAFileOfMistakesTheFirstThousandAreShown) {
    Diagnostics diagnostics;
    (void)parse("a: 1\n" + repeated("a: 2\n", 5000), diagnostics);
    EXPECT_EQ(diagnostics.errors(), 5000);
    EXPECT_EQ(diagnostics.sorted().size(), 1000U);
    EXPECT_THAT(diagnostics.render(), HasSubstr("; 4000 more are not shown."));
}

TEST(Yaml, AnExpressionWithABracketThatIsNotQuotedIsExplained) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse("expect:\n  v: {always: bus.B1.v_pu in [0.9, 1.1]}\n", diagnostics).has_value());
    EXPECT_THAT(diagnostics.render(), HasSubstr("put it in quotes"));
}

TEST(Yaml, WhatIsWrittenReadsBackTheSame) {
    Diagnostics diagnostics;
    std::string const text = "a: 1/48000\nb: \"30\"\nc: [x, y]\nd:\n  - k: \"a: b\"\n    m: {}\n  - [p, q]\ne: ~\n";
    auto const first = parse(text, diagnostics);
    ASSERT_TRUE(first && diagnostics.ok());
    auto const second = parse(to_yaml(*first), diagnostics);
    ASSERT_TRUE(second && diagnostics.ok());
    EXPECT_EQ(to_yaml(*first), to_yaml(*second));
    EXPECT_EQ(second->find("d")->items[0].find("k")->text, "a: b");
}

} // namespace
} // namespace gridspace::config
