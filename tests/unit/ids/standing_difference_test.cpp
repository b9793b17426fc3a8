// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/guarded_relay.hpp"
#include "common/random.hpp"
#include "common/source_tree.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/forecaster/model_file.hpp"

#include <cmath>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>

namespace gridspace::ids {
namespace {

constexpr double kPeakA = 10, kDegree = 3.141592653589793 / 180;
constexpr double kCycle = 80;

Model const& model() {
    static Model const out = *load_model(source_tree("configs/models/ar_20.json"));
    return out;
}

relay::RelayParams relay_params() {
    relay::RelayParams p;
    p.element.pickup_a = 0.3 * kPeakA / std::sqrt(2.0);
    p.element.slope_percent = 30;
    return p;
}

DetectorParams detector_params(double class_percent = 11) {
    DetectorParams p;
    p.guard.threshold.nominal_peak_a = kPeakA;
    p.supervisor.on_unconfirmed = SupervisorParams::OnUnconfirmed::block; // a fault that is not confirmed is lost
    p.standing.class_percent = class_percent;
    return p;
}

/// What a measuring chain does to the current of one end.
struct Chain {
    double ratio_percent{0}, minutes{0}; ///< of the transformer
    double late_us{0};
};

/// The currents of an end behind its chain: late by an angle and a time, through four samples as an interpolator would.
Abc measured(std::vector<Abc> const& i, std::size_t k, Chain const& chain) {
    double const late = chain.minutes / 60 * kDegree / (2 * 3.141592653589793) * kCycle + chain.late_us * 1e-6 * 4800;
    double const at = std::clamp(static_cast<double>(k) - late, 1.0, static_cast<double>(i.size()) - 3);
    auto const base = static_cast<std::size_t>(at);
    double const x = at - static_cast<double>(base);
    Abc out;
    for (std::size_t p = 0; p < 3; ++p) {
        double const a = i[base - 1][p], b = i[base][p], c = i[base + 1][p], d = i[base + 2][p];
        out[p] = (b + 0.5 * x * (c - a + x * (2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)))) *
                 (1 + chain.ratio_percent / 100);
    }
    return out;
}

struct Setting {
    char const* name;
    Chain from, to;
    double charging_percent{0}; ///< of the nominal current, a quarter of a cycle ahead of the voltage
};

struct Trips {
    int faults{0}, lost{0}, late{0}, not_armed{0}, chain{0};
};

/// 120 internal faults of the kinds in turn, with the relay alone and with the supervised one.
Trips trips(Setting const& setting, DetectorParams const& params) {
    Trips out;
    for (std::uint64_t n = 0; n < 120; ++n) {
        SyntheticParams grid;
        grid.radial_share = 0;
        auto const kind = static_cast<Situation>(static_cast<int>(Situation::internal_3ph) + static_cast<int>(n % 3));
        LineWaveform const w = synthesise(grid, kind, 11, n);
        relay::GuardedRelay with{relay_params(), model(), params}, without{relay_params()};
        std::int64_t trip_with = -1, trip_without = -1;
        bool not_armed = false, chain = false;
        for (std::size_t k = 0; k < w.size(); ++k) {
            relay::LineSample s{static_cast<std::int64_t>(k), {}, {}};
            s.from.i_a = measured(w.from, k, setting.from);
            s.to.i_a = measured(w.to, k, setting.to);
            for (std::size_t p = 0; p < 3; ++p) {
                s.from.i_a[p] += setting.charging_percent / 100 * kPeakA *
                                 std::cos(2 * 3.141592653589793 *
                                          (static_cast<double>(k) / kCycle - static_cast<double>(p) / 3 + 0.25));
            }
            s.from.present = s.to.present = true;
            trip_without = without.step(s).trip && trip_without < 0 ? s.index : trip_without;
            trip_with = with.step(s).trip && trip_with < 0 ? s.index : trip_with;
            Alarms const alarms = with.detector()->verdict().alarms;
            if (w.event < 0 || s.index < w.event) {
                not_armed = not_armed || (alarms & kNotArmed) != 0;
                chain = chain || (alarms & kMeasuringChain) != 0;
            }
        }
        if (trip_without < w.event) {
            continue; // no fault that this relay sees
        }
        ++out.faults;
        out.lost += trip_with < 0 ? 1 : 0;
        out.late += trip_with >= 0 && trip_with - trip_without > 1 ? 1 : 0; // 0.21 ms
        out.not_armed += not_armed ? 1 : 0;
        out.chain += chain ? 1 : 0;
    }
    return out;
}

std::vector<Setting> within_the_classes() {
    return {{"nothing", {}, {}},
            {"5P: 1 % and 60 minutes at each end", {1, 60, 0}, {-1, -60, 0}},
            {"80 us of skew", {0, 0, 80}, {}},
            {"charging current of 4 %", {}, {}, 4},
            {"all of these at once", {1, 60, 80}, {-1, -60, 0}, 4}};
}

TEST(StandingDifference, OfTheAccuracyClassesNeitherLosesNorDelaysAFault) {
    Trips const healthy = trips(within_the_classes()[0], detector_params());
    ASSERT_GT(healthy.faults, 100);
    for (Setting const& setting : within_the_classes()) {
        Trips const found = trips(setting, detector_params());
        std::printf("  %s: %d faults, %d lost, %d late\n", setting.name, found.faults, found.lost, found.late);
        EXPECT_LE(found.lost, healthy.lost) << setting.name << ": " << found.faults << " faults";
        EXPECT_LE(found.late, healthy.late) << setting.name;
        EXPECT_EQ(found.not_armed, 0) << setting.name;
        EXPECT_EQ(found.chain, 0) << setting.name;
    }
}

TEST(StandingDifference, WithoutItsEstimateFaultsWereLost) { // the negative control: nothing is taken away
    for (Setting const& setting : within_the_classes()) {
        Trips const found = trips(setting, detector_params(0));
        if (setting.from.late_us > 0 || setting.charging_percent > 0 || setting.from.minutes > 0) {
            std::printf("  %s: %d faults, %d lost, %d late\n", setting.name, found.faults, found.lost, found.late);
            EXPECT_GT(found.lost, 10) << setting.name;
        }
    }
}

/// A line that carries its nominal current for `seconds`, noise as in a substation; `forge` alters the `from` end.
struct Watched {
    std::int64_t chain_alarm{-1}, other_alarm{-1};
    double percent{0};
};
Watched watch(
    double seconds, std::function<void(std::int64_t, Abc&)> const& forge,
    std::function<double(double)> const& load = [](double) { return 1.0; }, Chain const& chain = {}) {
    LineDetector sut{model(), detector_params()};
    Random random{1, "noise"};
    Watched out;
    auto const n = static_cast<std::int64_t>(seconds * 4800);
    for (std::int64_t k = 0; k < n; ++k) {
        Abc from, to;
        double const peak = kPeakA * load(static_cast<double>(k) / 4800);
        for (std::size_t p = 0; p < 3; ++p) {
            double const w = 2 * 3.141592653589793 * (static_cast<double>(k) / kCycle - static_cast<double>(p) / 3);
            from[p] = peak * (1 + chain.ratio_percent / 100) * std::cos(w - chain.minutes / 60 * kDegree) +
                      0.02 * random.normal();
            to[p] = peak * std::cos(w) + 0.02 * random.normal();
        }
        forge(k, from);
        sut.step(k, {from, true}, {to, true}, false);
        Alarms const alarms = sut.verdict().alarms;
        out.chain_alarm = out.chain_alarm < 0 && (alarms & kMeasuringChain) != 0 ? k : out.chain_alarm;
        out.other_alarm =
            out.other_alarm < 0 && (alarms & ~static_cast<Alarms>(kMeasuringChain)) != 0 ? k : out.other_alarm;
    }
    out.percent = sut.standing().percent();
    return out;
}

void nothing(std::int64_t, Abc&) {}

TEST(StandingDifference, SaysHowLargeItIs) {
    EXPECT_NEAR(watch(0.5, nothing).percent, 0, 0.5);
    EXPECT_NEAR(watch(0.5, nothing, [](double) { return 1.0; }, {2, 0, 0}).percent, 2, 0.5);
    EXPECT_NEAR(watch(0.5, nothing, [](double) { return 1.0; }, {0, 180, 0}).percent, 5.2, 0.5);
}

TEST(StandingDifference, BeyondTheClassesIsAnAlarmOfTheMeasuringChain) {
    EXPECT_EQ(watch(0.5, nothing, [](double) { return 1.0; }, {8, 0, 0}).chain_alarm, -1);
    auto const found = watch(0.5, nothing, [](double) { return 1.0; }, {15, 0, 0});
    EXPECT_GE(found.chain_alarm, 0);
    EXPECT_LE(found.chain_alarm, 480);
}

TEST(StandingDifference, LoadsThatChangeAndChainsWithinTheirClassesRaiseNoAlarm) {
    auto const slowly = [](double t) { return 0.7 + 0.3 * std::sin(0.8 * t); };
    for (Chain const& chain : {Chain{}, Chain{2, 120, 0}, Chain{-2, -120, 0}}) {
        EXPECT_EQ(watch(20, nothing, slowly, chain).chain_alarm, -1) << chain.ratio_percent;
    }
}

TEST(StandingDifference, WhoMovesItSlowlyIsFound) {
    // Per cent a second, from 2 s on: what the forecaster and Kirchhoff's law do not see.
    for (double const rate : {120.0, 12.0, 1.0, 0.1}) {
        auto const found = watch(rate < 1 ? 40 : 12, [&](std::int64_t k, Abc& i) {
            double const t = static_cast<double>(k) / 4800 - 2;
            for (double& a : i) {
                a *= t > 0 ? 1 + rate / 100 * t : 1;
            }
        });
        ASSERT_GE(found.chain_alarm, 9600) << rate;
        bool const by_other = found.other_alarm >= 0 && found.other_alarm < found.chain_alarm; // fast: Kirchhoff's law
        double const delay_s = static_cast<double>(by_other ? found.other_alarm : found.chain_alarm) / 4800 - 2;
        std::printf("  %6.1f %% a second: alarm after %.2f s, at %.2f %%\n", rate, delay_s, rate * delay_s);
        EXPECT_LT(rate * delay_s, 11) << rate << " % a second: before the end of the class";
    }
}

TEST(StandingDifference, ASampleThatIsMissingDoesNotShiftIt) {
    LineDetector whole{model(), detector_params()}, sut{model(), detector_params()};
    for (std::int64_t k = 0; k < 4000; ++k) {
        Abc from, to;
        for (std::size_t p = 0; p < 3; ++p) {
            double const w = 2 * 3.141592653589793 * (static_cast<double>(k) / kCycle - static_cast<double>(p) / 3);
            from[p] = kPeakA * std::cos(w - 0.08);
            to[p] = kPeakA * std::cos(w);
        }
        whole.step(k, {from, true}, {to, true}, false);
        sut.step(k, {from, k % 500 != 250}, {to, true}, false);
        if (k > 700) {
            EXPECT_FALSE(sut.supervisor().differing()) << k;
        }
    }
    EXPECT_NEAR(sut.standing().percent(), whole.standing().percent(), 0.1);
}

} // namespace
} // namespace gridspace::ids
