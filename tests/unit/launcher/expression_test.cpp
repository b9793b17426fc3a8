// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/expression.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>

namespace gridspace::launcher {
namespace {

/// Evaluates with signals of these values; a name that is not among them fails the test.
double value_of(std::string const& text, std::map<std::string, std::vector<double>> const& signals = {}) {
    auto const sut = Expression::parse(text);
    EXPECT_TRUE(sut) << text << ": " << (sut ? "" : sut.error().message);
    if (!sut) {
        return -1e9;
    }
    std::vector<double> values;
    Expression::Bindings bindings;
    for (std::string const& name : sut->signals()) {
        bindings.emplace_back();
        for (double const v : signals.at(name)) {
            bindings.back().push_back(values.size());
            values.push_back(v);
        }
    }
    return sut->evaluate(bindings, values);
}

TEST(Expression, FollowsTheOrderOfOperations) {
    EXPECT_EQ(value_of("1 + 2 * 3"), 7);
    EXPECT_EQ(value_of("(1 + 2) * 3"), 9);
    EXPECT_EQ(value_of("8 / 2 / 2"), 2);
    EXPECT_EQ(value_of("2 - 3 - 4"), -5);
    EXPECT_EQ(value_of("- 2 * - 3"), 6);
    EXPECT_EQ(value_of("1 < 2 and 3 >= 3"), 1);
    EXPECT_EQ(value_of("1 > 2 or not 1 == 2"), 1);
    EXPECT_EQ(value_of("not 1 < 2 and 1 < 2"), 0);
    EXPECT_EQ(value_of("2 in [1, 3]"), 1);
    EXPECT_EQ(value_of("4 in [1, 3]"), 0);
}

TEST(Expression, FunctionsTakeAllSignalsOfAPattern) {
    std::map<std::string, std::vector<double>> const signals{{"bus.*.v_pu", {1.0, 0.9, 1.1}}, {"bus.B1.v_pu", {1.0}}};
    EXPECT_EQ(value_of("min(bus.*.v_pu)", signals), 0.9);
    EXPECT_EQ(value_of("max(bus.*.v_pu)", signals), 1.1);
    EXPECT_DOUBLE_EQ(value_of("mean(bus.*.v_pu)", signals), 1.0);
    EXPECT_DOUBLE_EQ(value_of("sum(bus.*.v_pu)", signals), 3.0);
    EXPECT_EQ(value_of("abs(bus.B1.v_pu - 3)", signals), 2);
    EXPECT_EQ(value_of("bus.B1.v_pu >= max(bus.*.v_pu)", signals), 0);
    EXPECT_EQ(value_of("max(abs(0 - 5), abs(3), 1)"), 5) << "functions of functions";
}

TEST(Expression, ComparisonsWithWhatIsNotKnownAreFalse) {
    std::map<std::string, std::vector<double>> const signals{{"a.b.c", {std::numeric_limits<double>::quiet_NaN()}}};
    EXPECT_EQ(value_of("a.b.c > 0", signals), 0);
    EXPECT_EQ(value_of("a.b.c <= 0", signals), 0);
}

TEST(Expression, TheSmallestAndTheLargestAreOfWhatIsKnownInAnyOrder) {
    double const nan = std::numeric_limits<double>::quiet_NaN();
    for (std::vector<double> const& values : {std::vector{nan, 2., 3.}, {2., nan, 3.}, {3., 2., nan}}) {
        EXPECT_EQ(value_of("min(r.*.ohm)", {{"r.*.ohm", values}}), 2);
        EXPECT_EQ(value_of("max(r.*.ohm)", {{"r.*.ohm", values}}), 3);
    }
    EXPECT_EQ(value_of("min(r.*.ohm) < 5", {{"r.*.ohm", {nan, nan}}}), 0);
}

TEST(Expression, NothingIsTrueOfADivisionByZero) {
    EXPECT_TRUE(std::isnan(value_of("1 / 0 > 1")));
    EXPECT_TRUE(std::isnan(value_of("not (0 / 0 > 1)")));
    EXPECT_EQ(value_of("1 == 1 or 1 / 0 > 1"), 1) << "not divided";
}

TEST(Expression, WordsOfTheLanguageAreNumbers) {
    EXPECT_EQ(value_of("true"), 1);
    EXPECT_EQ(value_of("false"), 0);
    EXPECT_EQ(value_of("breaker.CB3.position == open", {{"breaker.CB3.position", {word_value("open")}}}), 1);
    EXPECT_NE(word_value("open"), word_value("closed"));
    EXPECT_TRUE(std::isnan(word_value("bus")));
}

TEST(Expression, EdgesStandAtTheEnd) {
    EXPECT_EQ(Expression::parse("agent.mcca.curtailed rises")->edge(), Expression::Edge::rises);
    EXPECT_EQ(Expression::parse("a.b.c > 1 falls")->edge(), Expression::Edge::falls);
    EXPECT_EQ(Expression::parse("a.b.c")->edge(), Expression::Edge::none);
    EXPECT_TRUE(Expression::parse("bus.*.v_pu")->is_plain_signal());
    EXPECT_FALSE(Expression::parse("bus.*.v_pu + 1")->is_plain_signal());
}

TEST(Expression, MistakesAreNamed) {
    for (auto const& [text, word] : {std::pair{"", "early"},
                                     {"1 +", "early"},
                                     {"1 2", "2"},
                                     {"(1", ")"},
                                     {"max(a.b.c", ")"},
                                     {"foo(1)", "foo"},
                                     {"bus", "neither"},
                                     {"a.b.c > > 1", ">"},
                                     {"1 in [1", ","},
                                     {"1e999", "range"},
                                     {"$", "$"}}) {
        auto const sut = Expression::parse(text);
        ASSERT_FALSE(sut) << text;
        EXPECT_NE(sut.error().message.find(word), std::string::npos) << text << ": " << sut.error().message;
    }
}

TEST(Expression, NestingCannotOverflowTheStack) {
    for (std::string const part : {"(", "- ", "not ", "max("}) {
        std::string text;
        for (int i = 0; i < 100'000; ++i) {
            text += part;
        }
        EXPECT_FALSE(Expression::parse(text)) << part;
    }
}

TEST(Expression, LengthCannotOverflowTheStackAndIsReadAtOnce) {
    std::string longest = "1", text = "1";
    for (int i = 0; i < 50'000; ++i) {
        longest += i < 900 ? "+1" : "";
        text += "+1";
    }
    EXPECT_EQ(value_of(longest), 901);
    auto const sut = Expression::parse(text);
    ASSERT_FALSE(sut);
    EXPECT_NE(sut.error().message.find("more than 2000 words"), std::string::npos) << sut.error().message;
}

} // namespace
} // namespace gridspace::launcher
