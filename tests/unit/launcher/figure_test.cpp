// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figure.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

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

} // namespace
} // namespace gridspace::launcher
