// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/series.hpp"
#include "launcher/report/tables.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

config::Node yaml(std::string const& text) {
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(text, config::make_source("test", text), diagnostics);
    EXPECT_TRUE(node && diagnostics.ok()) << diagnostics.render();
    return node.value_or(config::Node::map());
}

/// What is wrong with a `report:`.
std::string mistakes(std::string const& text) {
    config::Diagnostics diagnostics;
    ReportSettings settings;
    config::read_fields(yaml(text), "report", diagnostics,
                        [&](config::Fields& f) { describe(f, settings, diagnostics); });
    return diagnostics.ok() ? "" : diagnostics.render();
}

Results run() {
    Results r;
    r.outcome.simulated_s = 10;
    r.mode = "lockstep";
    r.moments = {{"fault", 5.0}};
    r.signals["ev.EV1.soc_percent"] = {"%", {0, 4 * kSecond, 8 * kSecond}, {40, 60, 80}};
    r.signals["ev.EV2.soc_percent"] = {"%", {0, 4 * kSecond, 8 * kSecond}, {50, 60, 70}};
    r.signals["ev.EV1.current_a"] = {"A", {0}, {10}};
    r.signals["ev.EV2.current_a"] = {"A", {0}, {12}};
    r.signals["ct.CT1.i.a"] = {"A", {0, kSecond, 2 * kSecond, 3 * kSecond}, {3, -3, 3, -3}};
    r.signals["ct.CT2.i.a"] = {"A", {0, kSecond, 2 * kSecond, 3 * kSecond}, {-1, 1, -1, 1}};
    r.signals["breaker.CB1.position"] = {"dpc", {0, 6 * kSecond}, {2, 1}};
    return r;
}

std::vector<Figure> drawn(std::string const& figures, Results const& r = run()) {
    static WireTiming const none;
    config::Node const scenario = yaml("report:\n  figures:\n" + figures);
    return make_figures(report_settings(scenario), {r, scenario, none});
}

TEST(ReportFigures, APatternGivesALineForEachSignalThatFitsNamedByWhatTheStarStandsFor) {
    auto const sut = drawn("    soc: {title: Charge, label: 'SoC, %', signals: [ev.*.soc_percent]}\n");
    ASSERT_EQ(sut.size(), 1U);
    EXPECT_EQ(sut[0].title, "Charge");
    ASSERT_EQ(sut[0].series.size(), 2U);
    EXPECT_EQ(sut[0].series[1].name, "EV2");
    EXPECT_EQ(sut[0].to_s, 10);
}

TEST(ReportFigures, WhatIsTheSameThingsHasTheSameColourAndALabelOfItsOwn) {
    auto const sut = drawn("    x: {signals: [ev.*.soc_percent], series: {i: {of: ev.*.current_a, label: '* current', "
                           "dashed: true, right_axis: true}}}\n");
    ASSERT_EQ(sut[0].series.size(), 4U);
    EXPECT_EQ(sut[0].series[3].name, "EV2 current");
    EXPECT_EQ(sut[0].series[3].colour, sut[0].series[1].colour);
    EXPECT_NE(sut[0].series[3].colour, sut[0].series[2].colour);
    EXPECT_TRUE(sut[0].series[3].dashed && sut[0].series[3].right_axis);
    EXPECT_NE(to_svg(sut[0]).find("EV2 current"), std::string::npos);
}

TEST(ReportFigures, APhaseHasItsColourEverywhere) {
    Colours sut;
    EXPECT_EQ(sut.of("CT21 a"), 0);
    EXPECT_EQ(sut.of("CT22 c"), 2);
    EXPECT_EQ(sut.of("b"), 1);
    EXPECT_EQ(Colours{}.of("B1"), 0);
}

TEST(ReportFigures, AnExpressionIsOneLineAndItsRootMeanSquareIsOverTheWindow) {
    auto const sut =
        drawn("    d: {series: {sum: {of: ct.CT1.i.a + ct.CT2.i.a, label: differential a, rms_over_s: 2}}}\n");
    ASSERT_EQ(sut[0].series.size(), 1U);
    EXPECT_EQ(sut[0].series[0].name, "differential a");
    EXPECT_EQ(sut[0].series[0].values, (std::vector<double>{2, 2, 2, 2}));
    EXPECT_EQ(sliding_rms({0, kSecond, 2 * kSecond}, {3, 4, 0}, 2),
              (std::vector<double>{3, std::sqrt(12.5), std::sqrt(8)}));
}

TEST(ReportFigures, ARootMeanSquareIsUnknownWhereAValueOfItsWindowIsAndKnownAgainBehind) {
    double const nan = std::numeric_limits<double>::quiet_NaN();
    auto const rms = sliding_rms({0, kSecond, 2 * kSecond, 3 * kSecond}, {3, nan, 4, 4}, 2);
    EXPECT_EQ(rms[0], 3);
    EXPECT_TRUE(std::isnan(rms[1]));
    EXPECT_TRUE(std::isnan(rms[2]));
    EXPECT_EQ(rms[3], 4);
}

TEST(ReportFigures, APatternOfManyStarsIsComparedAtOnce) {
    EXPECT_EQ(captures("a*c*.d", "abcc.d"), (std::vector<std::string>{"b", "c"}));
    EXPECT_FALSE(captures("a*a*a*a*a*a*a*a*a*a*a*a*a*a*.b", std::string(90, 'a') + ".c"));
}

TEST(ReportFigures, AWindowIsRelativeToAnEventAndSoAreItsTimes) {
    auto const sut = drawn("    w: {signals: [ct.*.i.a], from: fault - 2 s, until: fault + 1 s, zero: fault}\n");
    EXPECT_EQ(sut[0].from_s, 3);
    EXPECT_EQ(sut[0].to_s, 6);
    EXPECT_EQ(sut[0].zero_s, 5);
    EXPECT_NE(to_svg(sut[0]).find("time since fault, s"), std::string::npos);
}

TEST(ReportFigures, AFigureAroundWhatDidNotHappenIsLeftOut) {
    Results r = run();
    r.moments.clear();
    EXPECT_TRUE(drawn("    w: {signals: [ct.*.i.a], from: fault - 2 s, until: fault + 1 s}\n", r).empty());
    EXPECT_TRUE(drawn("    w: {signals: [battery.*.soc_percent]}\n", r).empty());
}

TEST(ReportFigures, MarksAreAtInstantsAndAtTheFirstTimeThatSomethingHolds) {
    auto const sut =
        drawn("    m: {signals: [ct.*.i.a], marks: {due: {at: 4 s}, CB1_open: {when: breaker.CB1.position "
              "== open}, later: {at: relay.trip}}, shades: {open: {when: breaker.CB1.position == open}}}\n");
    ASSERT_EQ(sut[0].marks.size(), 2U);
    EXPECT_EQ(sut[0].marks[0].time_s, 4);
    EXPECT_EQ(sut[0].marks[1].label, "CB1 open");
    EXPECT_EQ(sut[0].marks[1].time_s, 6);
    ASSERT_EQ(sut[0].shades.size(), 1U);
    EXPECT_EQ(sut[0].shades[0].from_s, 6);
}

TEST(ReportFigures, InALaneABreakerIsUpWhereItIsOpenAndNotWhereItIsClosed) {
    auto sut = drawn("    d: {kind: digital, signals: [breaker.*.position]}\n");
    ASSERT_EQ(sut[0].series.size(), 1U);
    EXPECT_TRUE(sut[0].series[0].double_point);
    std::string const as_it_is = to_svg(sut[0]);
    sut[0].series[0] = {"CB1", {0, 6 * kSecond}, {0, 1}};
    EXPECT_NE(as_it_is.find("L"), std::string::npos);
    auto const path = [](std::string const& svg) { return svg.substr(svg.find("class=\"data\"")).substr(0, 90); };
    sut[0].series[0].steps = true;
    sut[0].series[0].colour = 0;
    EXPECT_EQ(path(as_it_is), path(to_svg(sut[0]))) << "as one that rises when the breaker opens";
}

TEST(ReportFigures, WhatIsExpectedOfADrawnSignalIsALine) {
    Results r = run();
    ExpectationResult e;
    e.verb = "min_of";
    e.of = "ev.*.soc_percent";
    e.band.low = 35;
    r.expectations.push_back(e);
    auto const sut = drawn("    soc: {signals: [ev.*.soc_percent], lines: {target: {value: 80}}}\n", r);
    ASSERT_EQ(sut[0].lines.size(), 2U);
    EXPECT_EQ(sut[0].lines[0].label, "target");
    EXPECT_EQ(sut[0].lines[1].label, "expected: 35");
}

TEST(ReportFigures, ASignalOfAKilledProcessEndsWithIt) {
    Results r = run();
    r.silences =
        silences(r.signals, {{"ems", {"ev.EV1.current_a", "ev.EV1.soc_percent"}}, {"sim", {"ev.EV2.soc_percent"}}},
                 {{5, "launcher", "loss", "ems killed"}, {6, "launcher", "x", "sim restarted"}});
    auto const sut = drawn("    a: {signals: [ev.*.current_a]}\n    b: {signals: [ev.*.soc_percent]}\n"
                           "    c: {series: {both: {of: ev.EV1.current_a + ev.EV2.soc_percent}}}\n",
                           r);
    EXPECT_EQ(sut[0].series[0].times_ns, (std::vector<std::int64_t>{0, 5 * kSecond}));
    EXPECT_TRUE(std::isnan(sut[0].series[0].values.back()));
    EXPECT_EQ(sut[0].series[1].values, std::vector<double>{12}) << "of the other nothing is lost";
    EXPECT_EQ(sut[1].series[0].times_ns, (std::vector<std::int64_t>{0, 4 * kSecond, 8 * kSecond, 8 * kSecond}))
        << "its last word was about a time after its end";
    EXPECT_TRUE(std::isnan(sut[1].series[0].values.back()));
    EXPECT_EQ(sut[1].series[1].values.size(), 3U) << "one that was started again at once goes on";
    EXPECT_EQ(sut[2].series[0].times_ns.back(), 5 * kSecond) << "and what is made of it ends, too";
}

TEST(ReportFigures, ASignalGoesOnWhereItsProcessIsBack) {
    Results r = run();
    r.silences = silences(r.signals, {{"ems", {"ev.EV1.soc_percent"}}},
                          {{5, "launcher", "loss", "ems killed"}, {6, "launcher", "x", "ems restarted"}});
    auto const sut = drawn("    b: {signals: [ev.EV1.soc_percent]}\n", r);
    EXPECT_EQ(sut[0].series[0].times_ns, (std::vector<std::int64_t>{0, 4 * kSecond, 5 * kSecond, 8 * kSecond}));
    EXPECT_TRUE(std::isnan(sut[0].series[0].values[2]));
    EXPECT_EQ(sut[0].series[0].values[3], 80);
}

TEST(ReportFigures, OtherKindsDrawTheSameSignalsInTheirWay) {
    auto const sut = drawn("    h: {kind: histogram, signals: [ct.CT1.i.a], bin: 1}\n"
                           "    e: {kind: ecdf, signals: [ct.CT1.i.a]}\n"
                           "    b: {kind: bar, signals: [ev.*.soc_percent], statistic: max}\n"
                           "    s: {kind: scatter, x: ct.CT2.i.a, signals: [ct.CT1.i.a]}\n"
                           "    d: {kind: digital, signals: [breaker.*.position]}\n");
    ASSERT_EQ(sut.size(), 5U);
    EXPECT_EQ(sut[0].series[0].values, (std::vector<double>{2, 0, 0, 0, 0, 0, 2}));
    EXPECT_EQ(sut[1].series[0].values.back(), 100);
    EXPECT_EQ(sut[2].x_names, (std::vector<std::string>{"EV1", "EV2"}));
    EXPECT_EQ(sut[2].series[0].values, (std::vector<double>{80, 70}));
    EXPECT_EQ(sut[3].series[0].times_ns.front(), -kSecond);
    EXPECT_EQ(sut[3].series[0].values.front(), 3);
    EXPECT_TRUE(sut[4].lanes);
    for (Figure const& f : sut) {
        EXPECT_EQ(to_svg(f).find("nan"), std::string::npos) << f.id;
    }
}

TEST(ReportFigures, WithoutAReportTheUsualFiguresAreDrawnOfWhatThereIs) {
    static WireTiming const none;
    config::Node const scenario = yaml("name: mine");
    Results const r = run();
    auto const sut = make_figures(report_settings(scenario), {r, scenario, none});
    ASSERT_EQ(sut.size(), 2U);
    EXPECT_EQ(sut[0].id, "state_of_charge");
    EXPECT_EQ(sut[1].id, "breakers");
    EXPECT_EQ(drawn("    own: {signals: [ct.*.i.a]}\n").size(), 1U) << "and only then";
    EXPECT_EQ(make_figures(report_settings(yaml("report: {usual: true, figures: {own: {signals: [ct.*.i.a]}}}")),
                           {r, scenario, none})
                  .size(),
              3U);
}

TEST(ReportTables, ACellIsGivenOrAskedOfTheRecordingOrCalculated) {
    config::Node const scenario = yaml("report:\n  tables:\n    t:\n      rows: [EV1, EV2]\n      columns:\n"
                                       "        wanted_s: {values: [7, 9]}\n"
                                       "        reached_s: {time_of: 'ev.{row}.soc_percent >= 80', digits: 1}\n"
                                       "        late_min: {header: 'late by, min', calculate: (column.reached_s - "
                                       "column.wanted_s) / 60, digits: 2}\n");
    auto const sut = make_tables(report_settings(scenario), run());
    ASSERT_EQ(sut.size(), 1U);
    EXPECT_EQ(sut[0].header, (std::vector<std::string>{"", "wanted_s", "reached_s", "late by, min"}));
    EXPECT_EQ(sut[0].rows[0], (std::vector<std::string>{"EV1", "7", "8.0", "0.02"}));
    EXPECT_EQ(sut[0].rows[1], (std::vector<std::string>{"EV2", "9", "–", "–"}));
}

TEST(ReportSettings, MistakesNameTheKeyAndWhatBelongsThere) {
    auto const says = [](std::string const& text, std::string const& what) {
        std::string const said = mistakes(text);
        EXPECT_NE(said.find(what), std::string::npos) << text << "\n" << said;
    };
    says("figures: {a: {kind: pie, signals: [x.y]}}", "pie");
    says("figures: {a: {title: nothing}}", "figure 'a' draws nothing");
    says("figures: {a: {signals: ['bus.*.v_pu +']}}", "is not an expression");
    says("figures: {a: {signals: [x.y], from: fault + 2 s, until: fault}}", "not after its begin");
    says("figures: {a: {signals: [x.y], from: 5}}", "is not an instant");
    says("figures: {a: {kind: scatter, signals: [x.y]}}", "`x` and `kind: scatter` go together");
    says("figures: {a: {signals: [x.y], marks: {m: {label: here}}}}", "needs `at` or `when`");
    says("figures: {a: {signals: [x.y], bands: {b: {from: 2, to: 1}}}}", "the lower bound belongs first");
    says("tables: {t: {rows: [A, B], columns: {c: {values: [1]}}}}", "1 values, and the table 2 rows");
    says("tables: {t: {rows: [A], columns: {c: {calculate: column.d + 1}}}}", "no column before it");
    says("tables: {t: {rows: [A], columns: {c: {last_of: x.y, values: [1]}}}}", "has 2 sources");
    EXPECT_EQ(mistakes("figures: {a: {signals: [x.y, max(y.*) - 1], from: 4 h, until: 5 h}}"), "");
}

/// Relays r1 (an internal fault, 10 samples a second), with values that its element would publish, and r2 (none).
Results run_of_relays() {
    Results r = run();
    for (int i = 0; i < 100; ++i) {
        std::int64_t const t = i * kSecond / 10;
        double const restraint = i < 50 ? 100 : i < 60 ? 100 + 90 * (i - 50) : 0;
        double const differential = i < 50 ? 1 : i < 60 ? 200 * (i - 50) : 0;
        for (char const* phase : {"a", "b", "c"}) {
            for (auto const& [quantity, value] :
                 {std::pair{"restraint_a.", restraint}, {"differential_a.", differential}}) {
                SignalSeries& s = r.signals[std::string{"relay.r1."} + quantity + phase];
                s.times_ns.push_back(t);
                s.values.push_back(value);
            }
        }
    }
    r.signals["relay.r1.restraint_a.a"].values[48] = std::nan(""); // it has no place in the plane
    r.signals["relay.r1.pickup"] = {"", {0, 5'200'000'000}, {0, 1}};
    r.signals["relay.r1.trip"] = {"", {0, 5'400'000'000}, {0, 1}};
    r.signals["relay.r1.sample_s"] = {"s", {0, 5'200'000'000, 5'400'000'000}, {0, 5.1, 5.3}};
    return r;
}

TEST(RestraintPlane, HasThePathOfEachPhaseInItsOrderAndTheCharacteristicWithItsCorners) {
    static WireTiming const none;
    config::Node const scenario =
        yaml("processes:\n"
             "  r1: {program: gridspace-relay, currents: {from: A, to: B}, trip: T, element: {pickup_a: 30, "
             "slope_percent: 30, slope2_percent: 80, slope2_from_a: 500}}\n"
             "  r2: {program: gridspace-relay, currents: {from: A, to: B}, trip: U, element: {pickup_a: 30}}\n"
             "report: {figures: {p: {kind: restraint, title: Plane, from: fault - 1 s, until: fault + 2 s, zero: "
             "fault}}}\n");
    Results const r = run_of_relays();
    auto const sut = make_figures(report_settings(scenario), {r, scenario, none});
    ASSERT_EQ(sut.size(), 1U) << "r2 publishes nothing";
    Figure const& f = sut[0];
    EXPECT_EQ(f.title, "Plane: r1");
    ASSERT_EQ(f.series.size(), 7U) << "the characteristic, and a path with named points for each phase";
    std::vector<std::pair<double, double>> corners;
    for (std::size_t i = 0; i < f.series[0].values.size(); ++i) {
        corners.emplace_back(static_cast<double>(f.series[0].times_ns[i]) / 1e9, f.series[0].values[i]);
    }
    // By hand: 30 A up to 30/0.3 = 100 A, 30 % up to 500 A (150 A), 80 % beyond: 150 + 0.8 (to - 500).
    double const to_a = 1.05 * 910;
    for (auto const& corner : {std::pair{0.0, 30.0}, {100.0, 30.0}, {500.0, 150.0}, {to_a, 150 + 0.8 * (to_a - 500)}}) {
        EXPECT_TRUE(std::ranges::any_of(corners, [&](auto const& c) {
            return std::abs(c.first - corner.first) < 1e-6 && std::abs(c.second - corner.second) < 1e-6;
        })) << corner.first;
    }
    EXPECT_EQ(f.series[1].values.front(), 1);
    EXPECT_EQ(f.series[3].values.size(), 31U) << "from 4 s to 7 s";
    EXPECT_EQ(f.series[1].values.size(), 30U) << "all but the one that is no number";
    EXPECT_EQ(f.series[1].values.back(), 0) << "it comes back to where there is no current, in its order";
    EXPECT_EQ(*std::ranges::max_element(f.series[1].values), 1800);
    EXPECT_EQ(f.series[2].point_names, (std::vector<std::string>{"", "pickup (100 ms)", "trip (300 ms)"}))
        << "of the samples that they come from, without the latency";
    EXPECT_FALSE(f.interactive());
    EXPECT_TRUE(to_csv(f).starts_with("series,x,value\ncharacteristic,0,30\n")) << to_csv(f).substr(0, 80);
    EXPECT_NE(to_svg(f).find("restraint current (mean of both ends), A"), std::string::npos);
}

TEST(RestraintPlane, OfRelaysWithoutTheirValuesThereIsNone) {
    Results r = run_of_relays();
    std::erase_if(r.signals, [](auto const& signal) { return signal.first.starts_with("relay.r1.restraint"); });
    static WireTiming const none;
    config::Node const scenario = yaml("processes: {r1: {program: gridspace-relay, element: {pickup_a: 30}}}\n"
                                       "report: {figures: {p: {kind: restraint}}}\n");
    EXPECT_TRUE(make_figures(report_settings(scenario), {r, scenario, none}).empty());
}

} // namespace
} // namespace gridspace::launcher
