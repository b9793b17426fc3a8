// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/mcca/mcca_logic.hpp"

#include <gtest/gtest.h>

namespace gridspace::agents {
namespace {

Mcca::Params params(MccaRules::Overlap overlap = MccaRules::Overlap::first_match) {
    Mcca::Params p;
    p.rules.overlap = overlap;
    p.evs = {"EV1", "EV2"};
    p.request_timeout = {30};
    return p;
}

Mcca::Outcome decide(Mcca& sut, double v1, double v2, std::int64_t at = 0) {
    EXPECT_FALSE(sut.request({at}, {"EV1", 10, v1, 360}));
    auto const out = sut.request({at}, {"EV2", 8, v2, 360});
    EXPECT_TRUE(out.has_value());
    return out.value_or(Mcca::Outcome{});
}

TEST(Mcca, GrantsEverythingWhileAllVoltagesAreHigh) {
    Mcca sut{params()};
    auto const out = decide(sut, 0.99, 0.971);
    EXPECT_EQ(out.decisions[0].current_a, 10);
    EXPECT_EQ(out.decisions[1].current_a, 8);
    EXPECT_FALSE(out.curtailed);
    EXPECT_EQ(out.period_s, 360);
}

TEST(Mcca, CurtailsAllWhenOneVoltageIsLow) {
    Mcca sut{params()};
    auto const out = decide(sut, 0.99, 0.97); // not above
    EXPECT_DOUBLE_EQ(out.decisions[0].current_a, 7.5);
    EXPECT_DOUBLE_EQ(out.decisions[1].current_a, 6);
    EXPECT_TRUE(out.curtailed);
    EXPECT_FALSE(out.undervoltage);
}

TEST(Mcca, StopsEvsAtUndervoltageAndHalvesTheOthers) {
    Mcca sut{params()};
    auto const out = decide(sut, 0.99, 0.955);
    EXPECT_DOUBLE_EQ(out.decisions[0].current_a, 5);
    EXPECT_DOUBLE_EQ(out.decisions[1].current_a, 0);
    EXPECT_TRUE(out.undervoltage);
}

TEST(Mcca, AVoltageThatIsNotANumberCountsAsUndervoltage) {
    Mcca sut{params()};
    EXPECT_TRUE(decide(sut, 0.99, std::numeric_limits<double>::quiet_NaN()).undervoltage);
}

TEST(Mcca, ARequestThatIsNoNumberIsNoRequest) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
    Mcca sut{params()};
    for (auto const& [request, fault] : {std::pair{MccaRequest{"EV2", kNan, 1, 360}, "current_a is nan"},
                                         {MccaRequest{"EV2", -kInf, 1, 360}, "current_a is -inf"},
                                         {MccaRequest{"EV2", 8, kInf, 360}, "v_pu is inf"},
                                         {MccaRequest{"EV2", 8, 1, kNan}, "period_s is nan"},
                                         {MccaRequest{"EV2", 8, 1, -1}, "period_s is -1"}}) {
        EXPECT_EQ(fault_of(request), fault);
        EXPECT_FALSE(sut.request({0}, request));
        EXPECT_FALSE(sut.deadline()) << "it does not begin a period";
    }
    EXPECT_EQ(fault_of({"EV2", 8, 1, 360}), std::nullopt);
    EXPECT_FALSE(sut.request({0}, {"EV1", 10, 0.99, 360}));
    EXPECT_FALSE(sut.request({1}, {"EV2", kNan, 0.99, 360}));
    auto const out = sut.elapse({30});
    ASSERT_TRUE(out.has_value()) << "as if EV2 had not asked";
    ASSERT_EQ(out->decisions.size(), 1U);
    EXPECT_EQ(out->decisions[0].current_a, 10);
}

TEST(Mcca, ReadsThePublishedOverlapInThreeWays) {
    Mcca first{params()}, safe{params(MccaRules::Overlap::safe)}, hysteresis{params(MccaRules::Overlap::hysteresis)};
    EXPECT_FALSE(decide(first, 0.972, 0.99).curtailed);
    EXPECT_TRUE(decide(safe, 0.972, 0.99).curtailed);
    EXPECT_FALSE(decide(hysteresis, 0.972, 0.99).curtailed);
    EXPECT_TRUE(decide(hysteresis, 0.969, 0.99).curtailed);
    EXPECT_TRUE(decide(hysteresis, 0.972, 0.99).curtailed);
    EXPECT_FALSE(decide(hysteresis, 0.976, 0.99).curtailed);
}

TEST(Mcca, DecidesAfterTheTimeoutWithThoseThatAsked) {
    Mcca sut{params()};
    EXPECT_FALSE(sut.request({100}, {"EV2", 8, 0.99, 360}));
    EXPECT_EQ(sut.deadline()->quanta, 130);
    EXPECT_FALSE(sut.elapse({129}));
    auto const out = sut.elapse({135});
    ASSERT_TRUE(out);
    EXPECT_EQ(out->time.quanta, 130);
    EXPECT_FALSE(out->complete);
    ASSERT_EQ(out->decisions.size(), 1U);
    EXPECT_EQ(out->decisions[0].ev, "EV2");
    EXPECT_FALSE(sut.deadline());
}

TEST(Mcca, ARequestAfterAnUnseenTimeoutStartsTheNextRound) {
    Mcca sut{params()};
    EXPECT_FALSE(sut.request({0}, {"EV1", 10, 0.99, 360}));
    auto const out = sut.request({360}, {"EV2", 8, 0.99, 360});
    ASSERT_TRUE(out);
    EXPECT_EQ(out->time.quanta, 30);
    EXPECT_EQ(out->decisions[0].ev, "EV1");
    EXPECT_EQ(sut.deadline()->quanta, 390);
}

TEST(Mcca, ANewerRequestOfTheSameEvReplacesTheOlder) {
    Mcca sut{params()};
    EXPECT_FALSE(sut.request({0}, {"EV1", 10, 0.99, 360}));
    EXPECT_FALSE(sut.request({1}, {"EV1", 4, 0.99, 360}));
    EXPECT_EQ(sut.request({2}, {"EV2", 8, 0.99, 360})->decisions[0].current_a, 4);
}

TEST(Mcca, StrangersAreIgnored) {
    Mcca sut{params()};
    EXPECT_FALSE(sut.request({0}, {"EV9", 10, 0.5, 360}));
    EXPECT_FALSE(sut.deadline());
}

} // namespace
} // namespace gridspace::agents
