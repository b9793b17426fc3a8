// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/rational.hpp"

#include <gtest/gtest.h>
#include <stdexcept>

namespace gridspace {
namespace {

TEST(Rational, ReadsDecimalsAndFractionsExactly) {
    EXPECT_EQ(Rational::parse("1/48000"), Rational(1, 48000));
    EXPECT_EQ(Rational::parse("0.25"), Rational(1, 4));
    EXPECT_EQ(Rational::parse("-1.5e-3"), Rational(-3, 2000));
    EXPECT_EQ(Rational::parse("1111.2"), Rational(5556, 5));
    EXPECT_EQ(Rational::parse("0.5/3"), Rational(1, 6));
    EXPECT_EQ(Rational::parse("1 / 3"), Rational(1, 3));
    EXPECT_EQ(Rational::parse("+2"), Rational(2));
    EXPECT_EQ(Rational::parse("1e3"), Rational(1000));
    EXPECT_EQ(Rational::parse("0.000"), Rational(0));
}

TEST(Rational, RefusesWhatIsNotANumber) {
    for (char const* text : {"", "/", "1/", "/2", "1/0", "1/2/3", "one", "0x10", "1e", "1e99", "--1", "1.2.3", "1 2",
                             "99999999999999999999", "nan", "inf"}) {
        EXPECT_FALSE(Rational::parse(text).has_value()) << text;
    }
}

TEST(Rational, ComputesInLowestTerms) {
    EXPECT_EQ(Rational(1, 6) + Rational(1, 3), Rational(1, 2));
    EXPECT_EQ(Rational(1, 2) - Rational(3, 4), Rational(-1, 4));
    EXPECT_EQ(Rational(2, 3) * Rational(3, 4), Rational(1, 2));
    EXPECT_EQ(Rational(1, 2) / Rational(-1, 4), Rational(-2));
    EXPECT_LT(Rational(1, 3), Rational(34, 100));
}

TEST(Rational, RoundsTowardsTheNamedSide) {
    EXPECT_EQ(Rational(7, 2).floor(), 3);
    EXPECT_EQ(Rational(7, 2).ceil(), 4);
    EXPECT_EQ(Rational(7, 2).round(), 4);
    EXPECT_EQ(Rational(-7, 2).floor(), -4);
    EXPECT_EQ(Rational(-7, 2).ceil(), -3);
    EXPECT_EQ(Rational(-7, 2).round(), -4);
    EXPECT_EQ(Rational(10, 3).round(), 3);
}

TEST(Rational, FindsTheCommonDivisorOfStepAndTick) {
    EXPECT_EQ(common_divisor(Rational(1), Rational(1, 4)), Rational(1, 4));
    EXPECT_EQ(common_divisor(Rational(1, 48000), Rational(4, 4800)), Rational(1, 48000));
    EXPECT_EQ(common_divisor(Rational(1, 4), Rational(1, 6)), Rational(1, 12));
}

TEST(Rational, OverflowIsAnErrorAndNotAWrongNumber) {
    Rational const huge{INT64_MAX};
    EXPECT_THROW((void)(huge * Rational{2}), std::overflow_error);
    EXPECT_THROW((void)Rational(1, 0), std::domain_error);
    EXPECT_THROW((void)(huge / Rational{0}), std::domain_error);
}

} // namespace
} // namespace gridspace
