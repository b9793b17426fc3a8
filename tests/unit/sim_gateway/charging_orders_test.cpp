// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What an agent decides, and what of it reaches the solver.
#include "sim/gateway/charging_orders.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace gridspace::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

/// What a charger was told, and when: all that is of interest here.
class RecordingEngine final : public Engine {
  public:
    explicit RecordingEngine(std::vector<std::pair<std::int64_t, double>>& told) : told_{told} {}
    Result<void> initialise() override { return {}; }
    Result<void> advance(SimTime until) override {
        now_ = until;
        return {};
    }
    Result<void> apply(Action const& action) override {
        told_.emplace_back(now_.quanta, std::get<SetParameter>(action).value);
        return {};
    }
    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t) const override { return 0; }

  private:
    std::vector<std::pair<std::int64_t, double>>& told_;
    std::vector<SignalDef> signals_;
    SimTime now_;
};

/// One EV, a quantum and a step of 1 s.
struct Orders : testing::Test {
    std::vector<std::pair<std::int64_t, double>> told; ///< s, A
    TimeBase base{Rational{1}};
    Simulation simulation{std::make_unique<RecordingEngine>(told), {base, {1}}, {}};
    ChargingOrders sut{base, {"EV1"}};

    void SetUp() override {
        ASSERT_TRUE(simulation.start([](SimTime) {}));
    }
    void run_until(std::int64_t s) {
        sut.expire(simulation, {s});
        ASSERT_TRUE(simulation.run_until({s}, [](SimTime) {}));
    }
    std::optional<std::string> take(double current_a, double valid_for_s) {
        return sut.take(simulation, simulation.now(), "EV1", current_a, valid_for_s);
    }
    using Told = std::vector<std::pair<std::int64_t, double>>;
};

TEST_F(Orders, ADecisionHoldsAsLongAsItSays) {
    EXPECT_EQ(take(7, 3), std::nullopt);
    run_until(10);
    EXPECT_EQ(told, (Told{{0, 7}, {3, 0}}));
}

TEST_F(Orders, AnotherDecisionTakesItsPlace) {
    EXPECT_EQ(take(7, 3), std::nullopt);
    run_until(2);
    EXPECT_EQ(take(8, 3), std::nullopt);
    run_until(10);
    EXPECT_EQ(told, (Told{{0, 7}, {2, 8}, {5, 0}}));
}

TEST_F(Orders, WhatIsNoCurrentIsRefusedAndTheOldOneHolds) {
    EXPECT_EQ(take(7, 5), std::nullopt);
    run_until(2);
    EXPECT_EQ(take(kNan, 100), "current_a is nan");
    run_until(10);
    EXPECT_EQ(told, (Told{{0, 7}, {5, 0}}));
    for (auto const& [value, said] :
         {std::pair{kInf, "current_a is inf"}, {-kInf, "current_a is -inf"}, {-kNan, "current_a is nan"}}) {
        EXPECT_EQ(ChargingOrders(base, {"EV1"}).take(simulation, {}, "EV1", value, 1), said);
    }
}

TEST_F(Orders, WhatIsNoDurationIsRefused) {
    for (auto const& [value, said] :
         {std::pair{kNan, "valid_for_s is nan"}, {kInf, "valid_for_s is inf"}, {-5.0, "valid_for_s is -5"}}) {
        EXPECT_EQ(ChargingOrders(base, {"EV1"}).take(simulation, {}, "EV1", 7, value), said);
    }
    run_until(10);
    EXPECT_EQ(told, Told{});
}

TEST_F(Orders, ARowOfRefusalsIsSaidOnce) {
    EXPECT_NE(take(kNan, 1), std::nullopt);
    EXPECT_EQ(take(kNan, 1), std::nullopt);
    EXPECT_EQ(take(7, 1), std::nullopt);
    EXPECT_NE(take(7, -1), std::nullopt);
}

TEST_F(Orders, ADurationBeyondAllTimesMeansForEver) {
    for (double const valid_for_s : {1e12, 1e300, std::numeric_limits<double>::max()}) {
        EXPECT_EQ(take(7, valid_for_s), std::nullopt);
        run_until(simulation.now().quanta + 10);
    }
    EXPECT_EQ(told, (Told{{0, 7}, {10, 7}, {20, 7}}));
    EXPECT_EQ(sut.take(simulation, {INT64_MAX}, "EV1", 7, 1e300), std::nullopt) << "stamped by somebody else's clock";
}

TEST_F(Orders, EvsOfOthersAreNotTouched) {
    EXPECT_FALSE(sut.has("EV2"));
    EXPECT_EQ(sut.take(simulation, {}, "EV2", 7, 3), std::nullopt);
    EXPECT_EQ(sut.take(simulation, {}, "EV2", kNan, 3), std::nullopt);
    run_until(10);
    EXPECT_EQ(told, Told{});
}

} // namespace
} // namespace gridspace::sim
