// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_words.hpp"

#include "common/config/yaml.hpp"
#include "sim/opendss/dss_numbers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::opendss {
namespace {

std::vector<std::string> shown(std::string const& line) {
    config::Diagnostics diagnostics;
    std::vector<std::string> out;
    for (Word const& word : words_of(line, {config::make_source("t", line), 1, 1}, diagnostics)) {
        out.push_back(word.name + (word.enclosed ? "=<" : "=") + word.value);
    }
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return out;
}

std::optional<double> value_of(std::string const& text) {
    config::Diagnostics diagnostics;
    auto const words = words_of("x=" + text, {config::make_source("t", text), 1, 1}, diagnostics);
    return evaluate(words.front(), diagnostics);
}

TEST(DssWords, AreSeparatedByBlanksAndCommasAndNamedByAnEqualsSign) {
    EXPECT_THAT(shown("New Load.S1a  Bus1=1.1, kV= 2.4\tkW =40"),
                testing::ElementsAre("=New", "=Load.S1a", "bus1=1.1", "kv=2.4", "kw=40"));
}

TEST(DssWords, AreHeldTogetherByEveryKindOfBracketAndQuote) {
    EXPECT_THAT(shown(R"(a=(1 2) b=[3, 4] c={5} d="6 7" e='8 9' [x (y z)])"),
                testing::ElementsAre("a=<1 2", "b=<3, 4", "c=<5", "d=<6 7", "e=<8 9", "=<x (y z)"));
}

TEST(DssWords, EndAtACommentButNotInsideBrackets) {
    EXPECT_THAT(shown("kW=1 !kvar=2"), testing::ElementsAre("kw=1"));
    EXPECT_THAT(shown("kW=1 // kvar=2"), testing::ElementsAre("kw=1"));
    EXPECT_THAT(shown("file=\"a//b!c\" x=a//b"), testing::ElementsAre("file=<a//b!c", "x=a//b"));
    EXPECT_THAT(shown("// all of it"), testing::IsEmpty());
}

TEST(DssWords, SayWhereABracketIsNotClosed) {
    config::Diagnostics diagnostics;
    std::string const line = "kVs=[2.4 2.4";
    (void)words_of(line, {config::make_source("t.dss", line), 1, 1}, diagnostics);
    EXPECT_THAT(diagnostics.render(), testing::HasSubstr("t.dss:1:5: error: '[' is not closed on this line"));
}

TEST(DssNumbers, AreArithmeticInReversePolishNotation) {
    EXPECT_DOUBLE_EQ(value_of("(8 1000 /)").value(), 0.008);
    EXPECT_DOUBLE_EQ(value_of("(0.00625 -1 * 1 +)").value(), 0.99375);
    EXPECT_DOUBLE_EQ(value_of("[1.051 0.88 0.001 3 * - - 115 12.47 / sqr *]").value(),
                     (1.051 - (0.88 - 0.003)) * (115 / 12.47) * (115 / 12.47));
    EXPECT_DOUBLE_EQ(value_of("\"2 3 ^\"").value(), 8);
    EXPECT_NEAR(value_of("(30 sin 3 sqrt 1 atan2 +)").value(), 60.5, 1e-12);
    EXPECT_DOUBLE_EQ(value_of("(1 2 swap -)").value(), 1);
    EXPECT_DOUBLE_EQ(value_of("+1.5e1").value(), 15);
}

TEST(DssNumbers, RefuseWhatHasNoValue) {
    for (char const* text : {"(1 +)", "(1 0 /)", "(-1 sqrt)", "()", "(2 times)", "12kV", "nan", "inf", "1e999"}) {
        EXPECT_FALSE(value_of(text).has_value()) << text;
    }
}

TEST(DssNumbers, StandInRowsPartedByBars) {
    config::Diagnostics diagnostics;
    std::string const line = "r=[1 | 2 (6 2 /) |4 5 6]";
    auto const words = words_of(line, {config::make_source("t", line), 1, 1}, diagnostics);
    auto const rows = rows_of(words.front(), diagnostics);
    EXPECT_THAT(rows.value(), testing::ElementsAre(testing::ElementsAre(1), testing::ElementsAre(2, 3),
                                                   testing::ElementsAre(4, 5, 6)));
}

} // namespace
} // namespace gridspace::opendss
