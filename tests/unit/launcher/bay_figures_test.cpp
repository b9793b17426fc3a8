// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Figures of relays with functions, from signals that are made up here.
#include "common/config/yaml.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/relay_settings_table.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

constexpr std::int64_t kMs = 1'000'000;

config::Node read(std::string const& text) {
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(text, config::make_source("test", text), diagnostics);
    EXPECT_TRUE(node && diagnostics.ok()) << diagnostics.render();
    return node.value_or(config::Node::map());
}

config::Node scenario_with(std::string const& functions) {
    return read("simulation: {gateways: {G: {publish: {BAY: {ct: T}}, subscribe: {Trip: [Q]}}}}\n"
                "processes:\n"
                "  mu: {program: gridspace-mu, from: BAY, to: SV}\n"
                "  r: {program: gridspace-relay, inputs: {currents: SV, voltages: SV}, trip: TRIP, functions: " +
                functions +
                "}\n"
                "  brk: {program: gridspace-breaker, from: TRIP.status, to: Trip}\n");
}

std::vector<Figure> drawn_of(config::Node const& scenario, Results const& r) {
    static WireTiming const none;
    return make_figures(report_settings(scenario), {r, scenario, none});
}

/// From the load to 2 + j6 ohm at 105 ms; the breaker parts at 150 ms, after which the loop runs away.
Results run_of_distance() {
    Results r;
    r.outcome.simulated_s = 0.3;
    r.mode = "lockstep";
    for (char const* loop : {"a", "b", "c", "ab", "bc", "ca"}) {
        SignalSeries resistance{"ohm", {}, {}}, reactance{"ohm", {}, {}};
        for (std::int64_t ms = 0; ms < 300; ++ms) {
            bool const faulted = std::string{loop} == "a";
            double const r_ohm = ms < 100   ? 90
                                 : ms < 105 ? 90 - 17.6 * static_cast<double>(ms - 100)
                                 : ms < 150 ? 2
                                            : 500;
            resistance.times_ns.push_back(ms * kMs);
            reactance.times_ns.push_back(ms * kMs);
            resistance.values.push_back(faulted && ms != 120 ? r_ohm : faulted ? std::nan("") : 90);
            reactance.values.push_back(faulted && ms != 120 ? (ms < 100   ? 20
                                                               : ms < 150 ? 6
                                                                          : 500)
                                       : faulted            ? std::nan("")
                                                            : 20);
        }
        r.signals["relay.r.PDIS1.r_ohm." + std::string{loop}] = resistance;
        r.signals["relay.r.PDIS1.x_ohm." + std::string{loop}] = reactance;
    }
    r.signals["relay.r.PDIS1.str"] = {"", {0, 108 * kMs, 160 * kMs}, {0, 1, 0}};
    r.signals["relay.r.PDIS1.op"] = {"", {0, 112 * kMs, 160 * kMs}, {0, 1, 0}};
    r.signals["breaker.Q.position"] = {"dpc", {0, 150 * kMs, 152 * kMs}, {2, 0, 1}};
    return r;
}

std::vector<std::complex<double>> points_of(Figure::Series const& s) {
    std::vector<std::complex<double>> out;
    for (std::size_t i = 0; i < s.values.size(); ++i) {
        out.emplace_back(static_cast<double>(s.times_ns[i]) / 1e9, s.values[i]);
    }
    return out;
}

Figure::Series const* named(Figure const& f, std::string const& name) {
    auto const it = std::ranges::find(f.series, name, &Figure::Series::name);
    return it == f.series.end() ? nullptr : &*it;
}

TEST(ImpedancePlane, IsThereWithoutBeingAskedAndShowsTheLoopThatComesNearUntilTheBreakerParts) {
    auto const sut =
        drawn_of(scenario_with("{PDIS1: {reach_ohm: 10, angle_deg: 60, publish_values: true}}"), run_of_distance());
    auto const plane = std::ranges::find(sut, "impedance_r", &Figure::id);
    ASSERT_NE(plane, sut.end());
    EXPECT_EQ(plane->title, "Measured impedance: r");
    Figure::Series const* a = named(*plane, "loop a");
    ASSERT_NE(a, nullptr);
    EXPECT_EQ(named(*plane, "loop bc"), nullptr) << "it stays at the load, far outside";
    auto const path = points_of(*a);
    EXPECT_EQ(path.front(), (std::complex<double>{90, 20}));
    EXPECT_NEAR(std::abs(path[149] - std::complex<double>{2, 6}), 0, 1e-9) << "the end, before the breaker parts";
    EXPECT_TRUE(std::ranges::none_of(path, [](auto z) { return z.real() > 400; }))
        << "what comes after is not the fault";
    EXPECT_TRUE(std::ranges::any_of(path, [](auto z) { return std::isnan(z.imag()); })) << "a gap stays a gap";
    EXPECT_NE(plane->note.find("Loop a ends at 2 + j6 ohm when the breaker parts"), std::string::npos) << plane->note;
    EXPECT_NEAR((plane->to_s - plane->from_s) / 784,
                (plane->y_range->second - plane->y_range->first) / plane->plot_height, 1e-9)
        << "a circle is one";
    EXPECT_NE(to_svg(*plane).find("PDIS1 operates at 0.1120 s"), std::string::npos);
    EXPECT_EQ(to_csv(*plane).find("nan"), std::string::npos);
}

TEST(ImpedancePlane, HasTheCircleOverTheReachAndInReverseItsMirrorImage) {
    auto const sut =
        drawn_of(scenario_with("{PDIS1: {reach_ohm: 10, angle_deg: 60, publish_values: true}, PDIS3: {reach_ohm: 4, "
                               "angle_deg: 60, direction: reverse}}"),
                 run_of_distance());
    auto const plane = std::ranges::find(sut, "impedance_r", &Figure::id);
    ASSERT_NE(plane, sut.end());
    std::vector<Figure::Series const*> circles;
    for (Figure::Series const& s : plane->series) {
        if (s.values.size() == 121) {
            circles.push_back(&s);
        }
    }
    ASSERT_EQ(circles.size(), 2U);
    std::complex<double> const half = std::polar(1.0, std::acos(0.5));
    for (std::size_t k = 0; k < 121; ++k) {
        EXPECT_NEAR(std::abs(points_of(*circles[0])[k] - 5.0 * half), 5, 1e-8);
        EXPECT_NEAR(std::abs(points_of(*circles[1])[k] + 2.0 * half), 2, 1e-8);
    }
}

TEST(ImpedancePlane, HasTheCornersOfAQuadrilateral) {
    auto const sut =
        drawn_of(scenario_with("{PDIS1: {characteristic: quadrilateral, reach_ohm: 10, angle_deg: 45, r_ohm: 4, "
                               "r_earth_ohm: 6, publish_values: true}}"),
                 run_of_distance());
    auto const plane = std::ranges::find(sut, "impedance_r", &Figure::id);
    ASSERT_NE(plane, sut.end());
    std::vector<Figure::Series const*> borders;
    for (Figure::Series const& s : plane->series) {
        if (s.values.size() == 5) {
            borders.push_back(&s);
        }
    }
    ASSERT_EQ(borders.size(), 2U) << "between phases, and to earth";
    // By hand, at 45 degrees: the upper corners are at X = 7.07 and 4 ohm beside the line, the lower ones where the
    // upright on the line through the origin meets the sides: 4 sin(45)^2 = 2.
    double const x = 10 / std::sqrt(2.0);
    auto const phases = points_of(*borders[0]);
    for (std::complex<double> const corner : {std::complex<double>{x + 4, x}, {x - 4, x}, {2, -2}, {-2, 2}}) {
        EXPECT_TRUE(std::ranges::any_of(phases, [&](auto z) { return std::abs(z - corner) < 1e-6; })) << corner;
    }
    EXPECT_NEAR(points_of(*borders[1])[0].real(), 3, 1e-6);
}

TEST(ImpedancePlane, OfARelayThatDoesNotPublishThereIsNone) {
    Results r = run_of_distance();
    std::erase_if(r.signals, [](auto const& s) { return s.first.find("_ohm") != std::string::npos; });
    auto const sut = drawn_of(scenario_with("{PDIS1: {reach_ohm: 10, angle_deg: 60}}"), r);
    EXPECT_TRUE(std::ranges::none_of(sut, [](Figure const& f) { return f.id.starts_with("impedance"); }));
}

TEST(TimeCurrent, HasTheTimesOfIec60255AndThePointAtWhichTheRelayOperates) {
    Results r;
    r.outcome.simulated_s = 20;
    r.mode = "lockstep";
    r.signals["relay.r.PTOC1.current_a.a"] = {"A", {0, 1000 * kMs, 12000 * kMs}, {50, 200, 0}};
    r.signals["relay.r.PTOC1.current_a.b"] = {"A", {0}, {50}};
    r.signals["relay.r.PTOC1.str"] = {"", {0, 1000 * kMs, 12000 * kMs}, {0, 1, 0}};
    r.signals["relay.r.PTOC1.op"] = {"", {0, 11029 * kMs, 12000 * kMs}, {0, 1, 0}};
    r.signals["relay.r.PTOC2.current_a"] = {"A", {0, 1000 * kMs, 2000 * kMs}, {0, 500, 0}};
    r.signals["relay.r.PTOC2.str"] = {"", {0, 1000 * kMs, 2000 * kMs}, {0, 1, 0}};
    r.signals["relay.r.PTOC2.op"] = {"", {0}, {0}};
    auto const sut = drawn_of(
        scenario_with(
            "{PTOC1: {pickup_a: 100, curve: iec_normal_inverse, publish_values: true}, PTOC2: {measures: residual, "
            "pickup_a: 400, delay_ms: 3000, publish_values: true}}"),
        r);
    auto const figure = std::ranges::find(sut, "time_current", &Figure::id);
    ASSERT_NE(figure, sut.end());
    Figure::Series const* curve = named(*figure, "r PTOC1");
    ASSERT_NE(curve, nullptr);
    // IEC 60255-151, curve A with a multiplier of 1: 10.03 s at twice, 4.28 s at five times, 2.97 s at ten times the
    // setting.
    for (auto const& [times, time_s] : {std::pair{2.0, 10.03}, {5.0, 4.28}, {10.0, 2.97}}) {
        double nearest = INFINITY, found = 0;
        for (std::size_t i = 0; i < curve->values.size(); ++i) {
            double const ratio = std::pow(10, static_cast<double>(curve->times_ns[i]) / 1e9) / 100;
            if (std::abs(ratio / times - 1) < nearest) {
                nearest = std::abs(ratio / times - 1);
                found = curve->values[i];
            }
        }
        EXPECT_LT(nearest, 0.02);
        EXPECT_NEAR(found, time_s, 0.04 * time_s) << times;
    }
    auto const points = std::ranges::find_if(figure->series, [](auto const& s) { return s.name.empty(); });
    EXPECT_EQ(points->point_names, std::vector<std::string>{"r PTOC1 operates"});
    EXPECT_NEAR(static_cast<double>(points->times_ns[0]) / 1e9, std::log10(200), 1e-9);
    EXPECT_NEAR(points->values[0], 10.029, 1e-9);
    EXPECT_NE(figure->note.find("r PTOC2 is started for 1 s with up to 500 A, and would need 3 s"), std::string::npos)
        << figure->note;
    EXPECT_NE(to_svg(*figure).find("starts only"), std::string::npos);
}

TEST(RelaySettings, AreSaidInTheTermsOfAManualWithTheirKeysAndUnits) {
    auto const text = [](std::string const& key, std::string const& value) {
        return setting_text(key, *read("{k: " + value + "}").find("k"));
    };
    EXPECT_EQ(text("slope2_from_a", "500"), "slope 2 from: 500 A (slope2_from_a)");
    EXPECT_EQ(text("delay_ms", "300"), "operate delay: 300 ms (delay_ms)");
    EXPECT_EQ(text("dead_times_ms", "[500, 1000]"), "dead times: 500, 1000 ms (dead_times_ms)");
    EXPECT_EQ(text("dead_line", "true"), "closing onto a dead line: yes (dead_line)");
    EXPECT_EQ(text("new_key_a", "1"), "new_key_a: 1 A") << "of a key without a term the key is said";
    auto const sut = relay_settings_table(scenario_with("{PDIS1: {reach_ohm: 2.64, publish_values: true}}"));
    ASSERT_EQ(sut.rows.size(), 1U);
    EXPECT_EQ(sut.rows[0][1], "T (stream SV)");
    EXPECT_EQ(sut.rows[0][2], "<span class=\"lines\"><b>PDIS1: distance zone, 21</b><br>reach, positive sequence: 2.64 "
                              "ohm (reach_ohm)<br></span>");
    EXPECT_EQ(sut.rows[0][3], "Q by TRIP");
}

} // namespace
} // namespace gridspace::launcher
