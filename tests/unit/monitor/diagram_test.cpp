// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/layout.hpp"
#include "monitor/diagram/picture.hpp"
#include "monitor/diagram/places.hpp"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

namespace gridspace::diagram {
namespace {

using testing::HasSubstr;
using testing::Not;

bool overlap(LabelBox const& a, LabelBox const& b) {
    return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

/// A connected grid of that many buses with meshes, parallel branches, switches at ends, relays and faults.
Grid random_grid(unsigned seed, std::size_t buses, bool with_places) {
    std::mt19937 random{seed};
    auto const below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    Grid out;
    for (std::size_t b = 0; b < buses; ++b) {
        std::string const name = "BUS" + std::to_string(b);
        Grid::Bus bus{name, name, 20000, {}, {}};
        if (with_places) {
            bus.x = static_cast<double>(below(5));
            bus.y = static_cast<double>(below(4));
        }
        out.buses.push_back(bus);
        if (b > 0) {
            out.branches.push_back({"L" + std::to_string(b), "L-" + std::to_string(b), "BUS" + std::to_string(below(b)),
                                    name, below(4) == 0 ? "transformer" : "line"});
        }
    }
    for (std::size_t extra = 0; extra < buses / 3; ++extra) {
        std::size_t const a = below(buses), b = below(buses);
        if (a != b) {
            out.branches.push_back({"X" + std::to_string(extra), "X" + std::to_string(extra), out.buses[a].name,
                                    out.buses[b].name, "line"});
        }
    }
    for (Grid::Branch const& branch : out.branches) {
        for (char const* end : {"from", "to"}) {
            if (below(2) == 0) {
                out.breakers.push_back({std::string{"CB"} + end + branch.name, branch.name, end});
            }
            if (below(3) == 0) {
                std::string const ct = std::string{"CT"} + end + branch.name;
                out.cts.push_back({ct, branch.name, end});
                out.relays.push_back({"relay_" + branch.name, {{"21", {}}, {"51", {}}}, {{ct, {}}}, {}});
            }
        }
    }
    char const* const kinds[] = {"load", "pv", "battery", "source", "generator", "ev", "wind_turbine"};
    for (std::size_t d = 0; d < buses; ++d) {
        std::string const name = "DEVICE" + std::to_string(d);
        out.devices.push_back({name, name, out.buses[below(buses)].name, kinds[below(7)]});
    }
    if (!out.branches.empty()) {
        out.faults.push_back(
            {"first", out.branches[below(out.branches.size())].name, "", static_cast<double>(below(101)), 1, {}});
    }
    out.faults.push_back({"at_bus", "", out.buses[below(buses)].name, 50, 2, {}});
    return out;
}

struct Cut {
    std::string branch, bus;
};

/// Where a branch runs through the bar of a bus at which it does not end.
std::vector<Cut> cuts(Layout const& sut) {
    std::vector<Cut> out;
    for (Route const& route : sut.routes) {
        for (Bar const& bar : sut.bars) {
            bool const own = bar.bus->name == route.branch->from || bar.bus->name == route.branch->to;
            for (std::size_t i = 1; i < route.path.size() && !own; ++i) {
                Point const a = route.path[i - 1], b = route.path[i];
                if (std::min(a.x, b.x) <= bar.x && bar.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= bar.bottom &&
                    bar.top <= std::max(a.y, b.y)) {
                    out.push_back({route.branch->name, bar.bus->name});
                }
            }
        }
    }
    return out;
}

Grid two_buses() {
    Grid out;
    out.buses = {{"A", "A", 20000, {}, {}}, {"B", "B", 20000, {}, {}}};
    out.branches = {{"AB", "A-B", "A", "B", "line"}};
    out.breakers = {{"QA", "AB", "from"}, {"QB", "AB", "to"}};
    out.cts = {{"TA", "AB", "from"}};
    out.relays = {{"relay_a", {{"21", {}}}, {{"TA", {}}}, {{"QA", {}}}}};
    return out;
}

class OneLineOfRandomGrids : public testing::TestWithParam<unsigned> {};

TEST_P(OneLineOfRandomGrids, HasNoTwoLabelsAtOnePlaceAndNoBranchThroughAForeignBar) {
    for (bool const with_places : {false, true}) {
        Grid const grid = random_grid(GetParam(), 2 + GetParam() % 18, with_places);
        for (bool const live : {false, true}) {
            Picture const sut = one_line(grid, {nullptr, live});
            for (std::size_t i = 0; i < sut.labels.size(); ++i) {
                for (std::size_t k = i + 1; k < sut.labels.size(); ++k) {
                    EXPECT_FALSE(overlap(sut.labels[i], sut.labels[k]))
                        << sut.labels[i].text << " and " << sut.labels[k].text << (with_places ? ", given places" : "");
                }
            }
        }
        for (Cut const& cut : cuts(lay_out(grid, false))) {
            ADD_FAILURE() << cut.branch << " runs through " << cut.bus;
        }
    }
}

TEST_P(OneLineOfRandomGrids, HasEachBranchFromBarToBarWithinThePicture) {
    Grid const grid = random_grid(GetParam(), 2 + GetParam() % 18, true);
    Layout const sut = lay_out(grid, false);
    ASSERT_EQ(sut.routes.size(), grid.branches.size());
    for (Route const& route : sut.routes) {
        for (auto const& [bus, at] :
             {std::pair{route.branch->from, route.path.front()}, {route.branch->to, route.path.back()}}) {
            auto const bar = std::ranges::find(sut.bars, bus, [](Bar const& b) { return b.bus->name; });
            EXPECT_NEAR(at.x, bar->x, 1e-9) << route.branch->name;
            EXPECT_GE(at.y, bar->top);
            EXPECT_LE(at.y, bar->bottom);
        }
        for (std::size_t i = 1; i < route.path.size(); ++i) {
            Point const a = route.path[i - 1], b = route.path[i];
            EXPECT_TRUE(a.x == b.x || a.y == b.y) << route.branch->name << " runs askew";
        }
        for (Point const p : route.path) {
            EXPECT_TRUE(p.x >= 0 && p.y >= 0 && p.x <= sut.width && p.y <= sut.height) << route.branch->name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, OneLineOfRandomGrids, testing::Range(1U, 41U));

TEST(OneLine, PutsBusesWhereTheNetworkSaysAndOtherwiseByTheirDistance) {
    Grid sut = two_buses();
    EXPECT_EQ(places(sut), (std::vector<Cell>{{0, 0}, {1, 0}}));
    sut.buses[0].x = 7;
    sut.buses[0].y = 2;
    sut.buses[1].x = 3;
    EXPECT_EQ(places(sut), (std::vector<Cell>{{0, 0}, {1, 0}})) << "one of them has no place";
    sut.buses[1].y = -1;
    EXPECT_EQ(places(sut), (std::vector<Cell>{{1, 1}, {0, 0}}));
    sut.buses[1] = {"B", "B", 20000, 7, 2};
    EXPECT_NE(places(sut)[0], places(sut)[1]) << "both say the same place";
}

TEST(OneLine, ShowsTheStateOfBreakersTheRelayAtItsTransformerAndTheFault) {
    Grid grid = two_buses();
    grid.faults = {{"fault", "AB", "", 60, 0.1, {}}};
    std::string const sut =
        one_line(grid, {[](std::string const& name) {
                            return name == "breaker.QA.position" ? std::optional{1.0} : std::nullopt;
                        },
                        false})
            .svg;
    EXPECT_THAT(sut, HasSubstr(R"(class="breaker opened" data-name="QA"><title>QA: open</title>)"));
    EXPECT_THAT(sut, HasSubstr(R"(class="breaker closed" data-name="QB")"));
    EXPECT_THAT(sut, HasSubstr("branch open"));
    EXPECT_THAT(sut, HasSubstr("relay relay_a 21 looks at TA"));
    EXPECT_THAT(sut, HasSubstr(R"(class="fault" data-name="fault"><title>fault at AB, 60 %, 0.1 s)"));
    EXPECT_THAT(one_line(grid, {nullptr, true}).svg, HasSubstr(R"(class="fault later")"));
}

TEST(OneLine, HasAFaultAtItsShareOfTheLineFromItsBegin) {
    Grid grid = two_buses();
    grid.breakers.clear();
    grid.cts.clear();
    Layout const sut = lay_out(grid, false);
    Route const& route = sut.routes[0];
    EXPECT_NEAR(route.at(0.6).x, 0.4 * sut.bars[0].x + 0.6 * sut.bars[1].x, 1e-9);
    std::swap(grid.branches[0].from, grid.branches[0].to);
    Layout const turned = lay_out(grid, false);
    EXPECT_NEAR(turned.routes[0].at(0.6).x, 0.6 * turned.bars[0].x + 0.4 * turned.bars[1].x, 1e-9);
}

TEST(OneLine, LetsNoNameBeMarkup) {
    Grid grid = two_buses();
    grid.buses[0].label = "<b>\"A\"&";
    grid.breakers[0].name = "<script>";
    std::string const sut = one_line(grid, {nullptr, false}).svg;
    EXPECT_THAT(sut, Not(HasSubstr("<b>")));
    EXPECT_THAT(sut, Not(HasSubstr("<script>")));
}

TEST(OneLine, OfAGridWithoutBranchesOrWithUnknownEndsStillHasItsBuses) {
    Grid grid;
    grid.buses = {{"A", "A", 400, {}, {}}};
    grid.branches = {{"L", "L", "A", "nowhere", "line"}};
    grid.devices = {{"D", "D", "nowhere", "load"}};
    EXPECT_THAT(one_line(grid, {nullptr, false}).svg, HasSubstr("data-name=\"A\""));
}

} // namespace
} // namespace gridspace::diagram
