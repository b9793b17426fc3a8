// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/judge/standing.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>

namespace gridspace::launcher {
namespace {

constexpr std::int64_t kNs = 1'000'000'000;
constexpr int kEndS = 10;

std::vector<Expectation> expectations_of(std::string const& text) {
    config::Diagnostics diagnostics;
    auto const node = config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);
    auto list = read_expectations(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return list;
}

/// What is known at an instant of a run that is whole in `all`.
SignalStore until(SignalStore const& all, double s) {
    SignalStore out;
    for (auto const& [name, series] : all) {
        out[name].unit = series.unit;
        for (std::size_t i = 0; i < series.times_ns.size() && static_cast<double>(series.times_ns[i]) <= s * 1e9; ++i) {
            out[name].times_ns.push_back(series.times_ns[i]);
            out[name].values.push_back(series.values[i]);
        }
    }
    return out;
}

/// 0, 1, 2 … at whole seconds, and a trip at 5 s.
SignalStore ramp() {
    SignalStore out;
    for (int t = 0; t <= kEndS; ++t) {
        out["ramp.R.value"].times_ns.push_back(t * kNs);
        out["ramp.R.value"].values.push_back(t);
    }
    out["relay.r.trip"] = {"", {0, 5 * kNs}, {0, 1}};
    return out;
}

ExpectationStanding ramp_at(double s, std::string const& settings) {
    auto const list = expectations_of("e: " + settings);
    return stand(list.at(0), until(ramp(), s), {{"fault", 4}}, s, kEndS, true);
}

TEST(Standing, AMaximumAboveItsUpperBoundHasFailedForGood) {
    std::string const settings = "{max_of: ramp.R.value, at_most: 6}";
    EXPECT_EQ(ramp_at(6, settings).standing, Standing::holds);
    ExpectationStanding const sut = ramp_at(7, settings);
    EXPECT_EQ(sut.standing, Standing::failed);
    EXPECT_EQ(sut.result.value, 7);
}

TEST(Standing, AMaximumAboveItsLowerBoundIsDecidedAndOneBelowMayComeYet) {
    EXPECT_EQ(ramp_at(3, "{max_of: ramp.R.value, at_least: 4}").standing, Standing::not_yet);
    EXPECT_EQ(ramp_at(4, "{max_of: ramp.R.value, at_least: 4}").standing, Standing::passed);
    EXPECT_EQ(ramp_at(4, "{max_of: ramp.R.value, between: [4, 12]}").standing, Standing::holds);
}

TEST(Standing, AMeanMayComeBackFromAnywhereUntilItsTimeIsOver) {
    EXPECT_EQ(ramp_at(3, "{mean_of: ramp.R.value, above: 100}").standing, Standing::not_yet);
    EXPECT_EQ(ramp_at(3, "{mean_of: ramp.R.value, above: 100, until: fault}").standing, Standing::not_yet);
    EXPECT_EQ(ramp_at(4, "{mean_of: ramp.R.value, above: 100, until: fault}").standing, Standing::failed);
    EXPECT_EQ(ramp_at(4, "{mean_of: ramp.R.value, is: 2, until: fault}").standing, Standing::passed);
    EXPECT_EQ(ramp_at(kEndS, "{mean_of: ramp.R.value, is: 5}").standing, Standing::passed);
}

TEST(Standing, NothingIsSaidBeforeTheTimeBeginsAndOfSignalsThatAreMadeAtTheEnd) {
    EXPECT_EQ(ramp_at(3, "{always: ramp.R.value > 3, from: fault}").standing, Standing::unknown);
    EXPECT_EQ(ramp_at(3, "{always: ramp.R.value > 3, from: relay.trip}").standing, Standing::unknown);
    EXPECT_EQ(ramp_at(8, "{last_of: ids.r.S.fakes, is: 0, until: fault}").standing, Standing::unknown);
    EXPECT_EQ(ramp_at(4, "{always: ramp.R.value > 3, from: fault}").standing, Standing::holds);
}

TEST(Standing, ATimeIsDecidedWhenItComesAndWhenItIsTooLate) {
    EXPECT_EQ(ramp_at(4.5, "{time_of: relay.r.trip == 1, since: fault, below: 2}").standing, Standing::unknown);
    ExpectationStanding const sut = ramp_at(5, "{time_of: relay.r.trip == 1, since: fault, below: 2}");
    EXPECT_EQ(sut.standing, Standing::passed);
    EXPECT_EQ(sut.result.value, 1);
    EXPECT_EQ(ramp_at(5, "{time_of: relay.r.trip == 1, since: fault, below: 0.5}").standing, Standing::failed);
    EXPECT_EQ(ramp_at(4.4, "{time_of: relay.r.trip == 1, since: fault, unit: ms, below: 500}").standing,
              Standing::unknown);
    EXPECT_EQ(ramp_at(4.6, "{time_of: relay.r.trip == 1, since: fault, unit: ms, below: 500}").standing,
              Standing::failed);
}

TEST(Standing, ConditionsAreDecidedByOneInstant) {
    EXPECT_EQ(ramp_at(4, "{never: relay.r.trip == 1}").standing, Standing::holds);
    EXPECT_EQ(ramp_at(5, "{never: relay.r.trip == 1}").standing, Standing::failed);
    EXPECT_EQ(ramp_at(4, "{eventually: relay.r.trip == 1}").standing, Standing::unknown);
    EXPECT_EQ(ramp_at(5, "{eventually: relay.r.trip == 1}").standing, Standing::passed);
    EXPECT_EQ(ramp_at(4.4, "{eventually: relay.r.trip == 1, from: fault, within_ms: 500}").standing, Standing::unknown);
    EXPECT_EQ(ramp_at(4.5, "{eventually: relay.r.trip == 1, from: fault, within_ms: 500}").standing, Standing::failed);
    EXPECT_EQ(ramp_at(4.5, "{last_of: ramp.R.value, show_only: true}").standing, Standing::shown);
}

constexpr char const* kOfEveryKind = R"(
al: {always: x.A.v < 3}
ne: {never: x.A.v > 3, from: fault}
ev: {eventually: x.A.v > 3 and x.B.v > 1}
ew: {eventually: x.A.v > 2, from: fault, within_s: 2}
t1: {time_of: x.A.v > 2, since: fault, below: 2}
t2: {time_of: x.S.on == 1 rises, since: fault, unit: ms, between: [100, 3000]}
t3: {time_of: x.S.on == 0, since: fault, at_least: 0.5}
t4: {time_of: x.B.v > 2.5, since: again, below: 1, from: fault}
mi: {min_of: x.A.v, above: -3}
mj: {min_of: x.A.v, below: -1, from: fault}
ma: {max_of: "x.*.v", below: 3.2}
mb: {max_of: x.A.v + x.B.v, between: [1, 5], until: again}
me: {mean_of: x.A.v, between: [-0.2, 0.2]}
md: {median_of: x.A.v, below: 0, until: again}
p9: {p99_of: x.B.v, below: 3}
c1: {count_of: x.S.on == 1 rises, at_most: 2}
c2: {count_of: x.S.on == 1 falls, at_least: 2, from: fault}
c3: {count_of: x.S.on == 1, between: [1, 4]}
la: {last_of: x.A.v, above: 0}
lb: {last_of: x.A.v, above: 0, until: again}
)";

/// Random walks, and a state that changes now and then.
SignalStore walks(std::mt19937& random) {
    SignalStore out;
    std::normal_distribution<double> step{0, 0.7};
    std::bernoulli_distribution changes{0.08};
    double a = 0, b = 0, on = 0;
    for (int i = 0; i <= 10 * kEndS; ++i) {
        std::int64_t const t = i * kNs / 10;
        a = 0.9 * a + step(random);
        b = 0.9 * b + step(random);
        for (auto const& [name, value] : {std::pair{"x.A.v", a}, {"x.B.v", b}}) {
            if (i % (name[2] == 'A' ? 1 : 3) == 0) {
                out[name].times_ns.push_back(t);
                out[name].values.push_back(value);
            }
        }
        if (i == 0 || changes(random)) {
            on = i == 0 ? 0 : 1 - on;
            out["x.S.on"].times_ns.push_back(t);
            out["x.S.on"].values.push_back(on);
        }
    }
    return out;
}

TEST(Standing, WhatIsDecidedEarlyIsWhatTheWholeRunIsJudged) {
    auto const expectations = expectations_of(kOfEveryKind);
    std::map<std::string, int> early_passes, early_failures;
    for (unsigned seed = 1; seed <= 100; ++seed) {
        std::mt19937 random{seed};
        SignalStore const whole = walks(random);
        double const again_s = 5.5 + 0.01 * static_cast<double>(seed % 7);
        Moments const all{{"fault", 2.05}, {"again", again_s}};
        for (Expectation const& e : expectations) {
            ExpectationResult const last = judge(e, whole, all, kEndS, true);
            for (double s = 0; s <= kEndS; s += 0.35) {
                Moments known = all;
                if (again_s > s) { // it is reported when it happens
                    known.erase("again");
                }
                ExpectationStanding const sut = stand(e, until(whole, s), known, s, kEndS, true);
                bool const passed = last.status == ExpectationResult::Status::passed;
                if (sut.standing == Standing::passed) {
                    EXPECT_TRUE(passed) << e.name.name << " of seed " << seed << " at " << s << " s";
                    early_passes[e.name.name] += s < kEndS ? 1 : 0;
                } else if (sut.standing == Standing::failed) {
                    EXPECT_FALSE(passed) << e.name.name << " of seed " << seed << " at " << s << " s";
                    early_failures[e.name.name] += s < kEndS ? 1 : 0;
                }
            }
            ExpectationStanding const sut = stand(e, whole, all, kEndS, kEndS, true);
            EXPECT_EQ(sut.standing,
                      last.status == ExpectationResult::Status::passed ? Standing::passed : Standing::failed)
                << e.name.name;
            EXPECT_EQ(sut.result.value, last.value) << e.name.name;
        }
    }
    // The control: it does decide early, both ways, and never where the value may still go anywhere.
    for (char const* name : {"al", "ne", "ew", "t1", "t2", "t4", "mi", "ma", "c1", "c3"}) {
        EXPECT_GT(early_failures[name], 0) << name;
    }
    for (char const* name : {"ev", "ew", "t1", "t2", "t3", "mj", "c2", "lb"}) {
        EXPECT_GT(early_passes[name], 0) << name;
    }
    for (char const* name : {"me", "p9", "la"}) {
        EXPECT_EQ(early_passes[name] + early_failures[name], 0) << name;
    }
}

} // namespace
} // namespace gridspace::launcher
