// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/bay_relay.hpp"

#include "agents/relay/functions/distance.hpp"
#include "agents/relay/functions/overcurrent.hpp"
#include "agents/relay/functions/reclosing.hpp"
#include "tests/unit/relay/functions/signals.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

using Kind = FunctionEvent::Kind;

FunctionSet overcurrent(double delay_s = 0.05) {
    PtocParams p;
    p.pickup_a = 200;
    p.delay_s = delay_s;
    std::vector<NamedFunction> functions;
    functions.push_back({"PTOC1", NodeClass::ptoc, true, std::make_unique<Ptoc>(p)});
    return FunctionSet{std::move(functions)};
}

BayParams bay(std::uint8_t inputs = kCurrents) {
    BayParams p;
    p.inputs = inputs;
    return p;
}

/// Samples of a current from `from` to `until`; what is true of `is_there` comes.
template <class IsThere>
void feed(BayRelay& sut, std::int64_t from, std::int64_t until, double rms, IsThere const& is_there) {
    for (std::int64_t k = from; k < until; ++k) {
        BaySample s{k, std::nullopt, std::nullopt, std::nullopt};
        if (is_there(k)) {
            s.i_a = at(balanced(rms), 60, static_cast<double>(k) / kRateHz);
        }
        sut.step(s);
    }
}
constexpr auto kAll = [](std::int64_t) { return true; };

TEST(BayRelay, TripsByItsFunctionAndKeepsTheTripUntilReset) {
    BayRelay sut{bay(), overcurrent()};
    EXPECT_TRUE(sut.blocked());
    feed(sut, 0, 480, 100, kAll);
    EXPECT_FALSE(sut.blocked());
    EXPECT_FALSE(sut.pickup());
    feed(sut, 480, 960, 500, kAll);
    EXPECT_TRUE(sut.trip());
    EXPECT_FALSE(sut.reset());
    feed(sut, 960, 1440, 0, kAll);
    EXPECT_TRUE(sut.trip());
    EXPECT_TRUE(sut.reset());
    std::vector<Kind> kinds;
    sut.events().drain([&](FunctionEvent const& e) { kinds.push_back(e.kind); });
    EXPECT_EQ(kinds, (std::vector{Kind::unblock, Kind::start, Kind::pickup, Kind::operate, Kind::trip, Kind::reset,
                                  Kind::dropout, Kind::release}));
}

TEST(BayRelay, DoesNotTripByAFaultThatIsClearedInTime) {
    BayRelay sut{bay(), overcurrent(0.1)};
    feed(sut, 0, 480, 100, kAll);
    feed(sut, 480, 800, 500, kAll); // 67 ms
    feed(sut, 800, 2000, 100, kAll);
    EXPECT_FALSE(sut.trip());
}

TEST(BayRelay, BridgesThreeLostSamplesAndRestsAfterFour) {
    for (int const lost : {3, 4}) {
        BayRelay whole{bay(), overcurrent()}, sut{bay(), overcurrent()};
        auto const gap = [&](std::int64_t k) { return k < 600 || k >= 600 + lost; };
        feed(whole, 0, 610, 500, kAll);
        feed(sut, 0, 610, 500, gap);
        EXPECT_EQ(sut.blocked(), lost == 4);
        if (lost == 3) {
            EXPECT_NEAR(std::abs(sut.measured().i[0]), std::abs(whole.measured().i[0]), 5);
        }
    }
}

TEST(BayRelay, IsBlockedWhenNothingComesAnyMore) {
    BayRelay sut{bay(), overcurrent()};
    feed(sut, 0, 480, 500, kAll);
    sut.lost(kCurrents);
    EXPECT_TRUE(sut.blocked());
    EXPECT_TRUE(sut.trip()); // the seal stays
}

TEST(BayRelay, ReleasesTheTripWhenItRecloses) {
    RrecParams r;
    r.open_below_a = 10;
    r.dead_times_s = {0.1};
    PtocParams p;
    p.pickup_a = 200;
    std::vector<NamedFunction> functions;
    functions.push_back({"PTOC1", NodeClass::ptoc, true, std::make_unique<Ptoc>(p)});
    functions.push_back({"RREC1", NodeClass::rrec, false, std::make_unique<Rrec>(r)});
    BayRelay sut{bay(), FunctionSet{std::move(functions)}};
    feed(sut, 0, 480, 100, kAll);
    feed(sut, 480, 700, 500, kAll);
    EXPECT_TRUE(sut.trip());
    feed(sut, 700, 1500, 0, kAll);
    EXPECT_FALSE(sut.trip());
}

TEST(BayRelay, MeasuresDistanceByTwoInputsAndFrequencyByTheVoltage) {
    PdisParams z;
    z.reach_ohm = 8;
    std::vector<NamedFunction> functions;
    functions.push_back({"PDIS1", NodeClass::pdis, true, std::make_unique<Pdis>(z)});
    BayRelay sut{bay(kCurrents | kVoltages), FunctionSet{std::move(functions)}};
    auto const step = [&](std::int64_t k, Complex i, Complex v) {
        double const t = static_cast<double>(k) / kRateHz;
        sut.step({k, at(balanced(i), 59.5, t), at(balanced(v), 59.5, t), std::nullopt});
    };
    std::int64_t k = 0;
    for (; k < 1200; ++k) {
        step(k, 1, 100);
    }
    EXPECT_FALSE(sut.pickup());
    EXPECT_NEAR(sut.measured().frequency_hz, 59.5, 1e-6);
    EXPECT_NEAR(std::abs(sut.measured().v[1]), 100, 1e-6);
    for (; k < 1400; ++k) {
        step(k, polar(10, -75), 50); // 5 ohm at 75 degrees
    }
    EXPECT_TRUE(sut.trip());
}

/// The largest errors of frequency and of its rate in half a second in which `lost` samples of `inputs` are missing.
std::pair<double, double> frequency_errors(std::int64_t lost, std::uint8_t inputs) {
    constexpr double kHz = 59.5;
    BayRelay sut{bay(kCurrents | kVoltages), overcurrent()};
    std::pair<double, double> worst{};
    for (std::int64_t k = 0; k < 3600; ++k) {
        double const t = static_cast<double>(k) / kRateHz;
        std::uint8_t const missing = k >= 1200 && k < 1200 + lost ? inputs : std::uint8_t{0};
        BaySample s{k, at(balanced(1), kHz, t), at(balanced(100), kHz, t), std::nullopt};
        s.i_a = (missing & kCurrents) != 0 ? std::nullopt : s.i_a;
        s.v_v = (missing & kVoltages) != 0 ? std::nullopt : s.v_v;
        sut.step(s);
        if (k >= 1200) {
            worst.first = std::max(worst.first, std::abs(sut.measured().frequency_hz - kHz));
            worst.second = std::max(worst.second, std::abs(sut.measured().rocof_hz_per_s));
        }
    }
    return worst;
}

TEST(BayRelay, MeasuresTheFrequencyAcrossLostSamples) {
    for (std::int64_t const lost : {0, 1, 2, 3}) {
        for (std::uint8_t const inputs : {kCurrents, kVoltages, static_cast<Quantity>(kCurrents | kVoltages)}) {
            SCOPED_TRACE(testing::Message() << lost << " of " << int{inputs});
            auto const [hz, hz_per_s] = frequency_errors(lost, inputs);
            EXPECT_LT(hz, 0.02);
            EXPECT_LT(hz_per_s, 0.3);
        }
    }
}

TEST(BayRelay, MeasuresTheFrequencyWhenItsCurrentsAreLost) {
    BayRelay sut{bay(kCurrents | kVoltages), overcurrent()};
    for (std::int64_t k = 0; k < 2400; ++k) {
        double const t = static_cast<double>(k) / kRateHz;
        BaySample s{k, at(balanced(1), 59.5, t), at(balanced(100), 59.5, t), std::nullopt};
        s.i_a = k >= 1200 ? std::nullopt : s.i_a;
        sut.step(s);
        if (k == 1300) {
            sut.lost(kCurrents);
        }
        if (k >= 1200) {
            ASSERT_NEAR(sut.measured().frequency_hz, 59.5, 1e-6) << k;
        }
    }
}

} // namespace
} // namespace gridspace::relay
