// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/elementary.hpp"
#include "common/random.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace gridspace {
namespace {

/// The largest error of `f` against the libm of this machine, in units of 2^-52 of the larger of |value| and `floor`.
template <class F, class G>
double worst_ulp(F f, G libm, double low, double high, double floor = 0) {
    Random random{1};
    double worst = 0;
    for (int i = 0; i < 200'000; ++i) {
        double const x = random.uniform(low, high), expected = libm(x);
        double const unit = std::max(std::fabs(expected), floor) * 0x1p-52;
        worst = std::max(worst, std::fabs(f(x) - expected) / unit);
    }
    return worst;
}

TEST(Elementary, AgreesWithTheMathLibraryToAFewUnitsInTheLastPlace) {
    EXPECT_LE(worst_ulp(elementary::sin, [](double x) { return std::sin(x); }, -1e4, 1e4, 1e-3), 2);
    EXPECT_LE(worst_ulp(elementary::cos, [](double x) { return std::cos(x); }, -1e4, 1e4, 1e-3), 2);
    EXPECT_LE(worst_ulp(elementary::exp, [](double x) { return std::exp(x); }, -50, 50), 3);
    EXPECT_LE(worst_ulp(elementary::log, [](double x) { return std::log(x); }, 1e-6, 1e3, 1e-3), 3);
    EXPECT_LE(worst_ulp(elementary::tanh<double>, [](double x) { return std::tanh(x); }, -3, 3), 4);
    EXPECT_LE(worst_ulp(elementary::tanh<double>, [](double x) { return std::tanh(x); }, -30, 30), 4);
    EXPECT_LE(worst_ulp([](double a) { return elementary::atan2(std::sin(a), std::cos(a)); },
                        [](double a) { return std::atan2(std::sin(a), std::cos(a)); }, -3.14, 3.14),
              4);
}

TEST(Elementary, TanhOfFloatAgreesWithDouble) {
    for (int i = -2000; i <= 2000; ++i) {
        float const x = static_cast<float>(i) * 0.01F;
        EXPECT_NEAR(elementary::tanh(x), elementary::tanh(static_cast<double>(x)), 2e-7);
    }
}

TEST(Elementary, TanhSaturatesAndKeepsNotANumber) {
    EXPECT_EQ(elementary::tanh(1e300), 1);
    EXPECT_EQ(elementary::tanh(-std::numeric_limits<double>::infinity()), -1);
    EXPECT_TRUE(std::isnan(elementary::tanh(std::numeric_limits<double>::quiet_NaN())));
    EXPECT_EQ(elementary::tanh(0.0), 0);
    EXPECT_EQ(elementary::tanh(1e30F), 1);
}

TEST(Random, HasTheMomentsOfItsDistributions) {
    Random sut{42};
    constexpr int kCount = 200'000;
    double sum = 0, squares = 0, uniform = 0;
    for (int i = 0; i < kCount; ++i) {
        double const x = sut.normal();
        sum += x;
        squares += x * x;
        uniform += sut.uniform();
    }
    EXPECT_NEAR(sum / kCount, 0, 0.01);
    EXPECT_NEAR(squares / kCount, 1, 0.02);
    EXPECT_NEAR(uniform / kCount, 0.5, 0.005);
}

TEST(Random, RepeatsWithItsSeedAndDiffersBetweenStreams) {
    Random a{7, "noise"}, b{7, "noise"}, other{7, "fakes"}, next_seed{8, "noise"};
    int same_stream = 0, same_seed = 0;
    for (int i = 0; i < 100; ++i) {
        auto const x = a.next();
        EXPECT_EQ(x, b.next());
        same_stream += x == other.next() ? 1 : 0;
        same_seed += x == next_seed.next() ? 1 : 0;
    }
    EXPECT_EQ(same_stream, 0);
    EXPECT_EQ(same_seed, 0);
}

TEST(Random, BelowCoversItsRangeEvenly) {
    Random sut{3};
    std::vector<int> count(6);
    for (int i = 0; i < 60'000; ++i) {
        ++count.at(sut.below(6));
    }
    for (int const c : count) {
        EXPECT_NEAR(c, 10'000, 400);
    }
    EXPECT_EQ(sut.below(1), 0U);
}

} // namespace
} // namespace gridspace
