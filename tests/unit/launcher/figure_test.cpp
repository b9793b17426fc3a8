// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figure.hpp"
#include "launcher/report/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr char const* kEvil = "bus.</script><script>alert(1)</script>\"\\\xe2\x80\xa8 & 'x' \x1b[2J";

Figure evil() {
    Figure out;
    out.id = out.title = out.y_label = out.x_label = out.axis = out.shade_label = kEvil;
    out.series.push_back({kEvil, {0, 1'000'000'000}, {1, 2}});
    out.marks.push_back({kEvil, 0.5, -1});
    out.lines.push_back({kEvil, 1.5});
    out.shades.push_back({0.1, 0.2});
    out.to_s = 1;
    return out;
}

TEST(Figure, ANameInItsDataNeitherEndsTheScriptNorTheLine) {
    std::string const sut = to_json(evil());
    EXPECT_THAT(sut, Not(HasSubstr("<")));
    EXPECT_THAT(sut, Not(HasSubstr("\xe2\x80\xa8")));
    auto const read = nlohmann::json::parse(sut);
    EXPECT_EQ(read["series"][0]["name"], kEvil) << "and it is the same name for whoever reads it";
    EXPECT_EQ(read["id"], kEvil);
}

TEST(Figure, ANameInItsDrawingIsText) {
    Figure figure = evil();
    figure.id = "x"; // which the report makes a file name of
    std::string const sut = to_svg(figure);
    EXPECT_THAT(sut, Not(HasSubstr("<script")));
    EXPECT_THAT(sut, Not(HasSubstr("\x1b")));
    EXPECT_THAT(sut, Not(HasSubstr("\"\\")));
}

Figure over(double until_s) {
    Figure out;
    out.id = "x";
    out.to_s = until_s;
    out.series.push_back({"a", {0, static_cast<std::int64_t>(until_s * 1e9)}, {1, 2}});
    return out;
}

std::vector<double> ticks_of(Figure const& figure) {
    std::string const svg = to_svg(figure);
    std::vector<double> out;
    for (std::size_t at = 0; (at = svg.find("<g class=\"tx\">", at)) != std::string::npos; ++at) {
        std::size_t const text = svg.find("middle\">", at) + 8;
        out.push_back(std::stod(svg.substr(text)));
    }
    return out;
}

TEST(Figure, HoursAndMinutesHaveTicksAsOnAClock) {
    EXPECT_THAT(ticks_of(over(24 * 3600)), ElementsAre(0, 3, 6, 9, 12, 15, 18, 21, 24));
    EXPECT_THAT(ticks_of(over(7 * 24 * 3600)), ElementsAre(0, 24, 48, 72, 96, 120, 144, 168));
    EXPECT_THAT(ticks_of(over(8 * 3600)), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_THAT(ticks_of(over(110 * 60)), ElementsAre(0, 15, 30, 45, 60, 75, 90, 105));
    EXPECT_THAT(ticks_of(over(25)), ElementsAre(0, 2.5, 5, 7.5, 10, 12.5, 15, 17.5, 20, 22.5, 25));
    EXPECT_THAT(ticks_of(over(300 * 24 * 3600.0)), ElementsAre(0, 1000, 2000, 3000, 4000, 5000, 6000, 7000))
        << "hours of a year are counted in tens again";
}

TEST(Figure, AnAxisOfLargeValuesThatHardlyDifferHasAnEnd) {
    for (double const low : {2e6, 1.7e9, -2e6}) {
        std::vector<double> const sut = ticks(low, low + 1e-9, 6, "");
        EXPECT_LT(sut.size(), 20U) << low;
        EXPECT_TRUE(std::ranges::is_sorted(sut));
    }
}

TEST(Figure, ANameWithACommaIsOneColumnOfItsData) {
    Figure sut = over(10);
    sut.series[0] = {"max(a, \"b\")", {0}, {1}, true};
    EXPECT_EQ(to_csv(sut), "time_s,\"max(a, \"\"b\"\")\"\n0,1\n");
    sut.series[0].path = true;
    EXPECT_EQ(to_csv(sut), "series,x,value\n\"max(a, \"\"b\"\")\",0,1\n");
}

TEST(Figure, ALineEndsWhereItsValuesEnd) {
    Figure sut = over(10);
    double const none = std::numeric_limits<double>::quiet_NaN();
    sut.series[0] = {"a", {0, 2'000'000'000, 4'000'000'000, 7'000'000'000}, {1, 3, none, 2}, true};
    std::string const svg = to_svg(sut);
    std::string const path = svg.substr(svg.find("class=\"data\" d=\"") + 16);
    std::string const drawn = path.substr(0, path.find('"'));
    EXPECT_EQ(std::count(drawn.begin(), drawn.end(), 'M'), 2) << drawn;
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_EQ(to_csv(sut), "time_s,a\n0,1\n2,3\n4,\n7,2\n");
    EXPECT_THAT(to_json(sut), HasSubstr("\"v\":[1,3,null,2]"));
}

TEST(Figure, AnEndIsDrawnAmongManyValues) {
    Figure sut = over(20000);
    Figure::Series& s = sut.series[0];
    s.times_ns.clear();
    s.values.clear();
    for (std::int64_t i = 0; i < 20000; ++i) {
        s.times_ns.push_back(i * 1'000'000'000);
        s.values.push_back(i >= 7001 && i < 7002 ? std::numeric_limits<double>::quiet_NaN()
                                                 : static_cast<double>(i % 7));
    }
    auto const points = drawn_points(s, 0, 20000);
    EXPECT_EQ(std::count_if(points.begin(), points.end(), [](auto const& p) { return std::isnan(p.second); }), 1);
    EXPECT_LT(points.size(), 5000U);
}

TEST(Figure, OfMoreThanAMillionValuesKeepsThoseOfItsWindowOrWhatIsDrawnOfThem) {
    Figure::Series all{"a", {}, {}};
    for (std::int64_t i = 0; i < 1'500'000; ++i) {
        all.times_ns.push_back(i * 1'000'000);
        all.values.push_back(i == 700'001 ? 1000 : static_cast<double>(i % 7));
    }
    Figure::Series window = all, whole = all, few = all;
    shorten(window, 0.9995, 1.9995);
    EXPECT_EQ(window.times_ns.size(), 1001U);
    EXPECT_EQ(window.times_ns.front(), 999'000'000) << "what holds when the window begins";
    shorten(whole, 0, 1500);
    EXPECT_LT(whole.values.size(), 5000U);
    EXPECT_EQ(*std::max_element(whole.values.begin(), whole.values.end()), 1000);
    few.times_ns.resize(1'000'000);
    few.values.resize(1'000'000);
    shorten(few, 0.9995, 1.9995);
    EXPECT_EQ(few.values.size(), 1'000'000U);
}

TEST(Figure, OfASignalThatDiffersByRoundingOnlyIsThatOfAConstant) {
    Figure figure;
    figure.id = "x";
    figure.to_s = 1;
    figure.series.push_back({"hz", {0, 1'000'000'000}, {60, 60.00000000000001}});
    EXPECT_THAT(to_svg(figure), HasSubstr(">62<")) << "its ticks are those of 60 +- 5 %";
    figure.series[0].values = {60, 60.1};
    EXPECT_THAT(to_svg(figure), Not(HasSubstr(">62<")));
}

} // namespace
} // namespace gridspace::launcher
