// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/one_line_figure.hpp"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// A run folder whose monitor would be told of a chain of so many buses, with a breaker in its first line.
class OneLineFigure : public testing::Test {
  protected:
    Results run_of(std::size_t buses) {
        fs::path const folder =
            fs::path{testing::TempDir()} / ("one_line_" + std::to_string(::getpid()) + "_" + std::to_string(buses));
        fs::remove_all(folder);
        fs::create_directories(folder / "report" / "figures");
        std::ofstream out{folder / "monitor.yaml"};
        out << "settings:\n  run:\n    mode: lockstep\n    buses:\n";
        for (std::size_t b = 0; b < buses; ++b) {
            out << "    - {name: B" << b << ", label: B" << b << ", voltage_v: 400}\n";
        }
        out << "    branches:\n";
        for (std::size_t b = 1; b < buses; ++b) {
            out << "    - {name: L" << b << ", label: L" << b << ", from: B" << b - 1 << ", to: B" << b
                << ", kind: line}\n";
        }
        out << "    breakers: [{name: Q, line: L1, end: from}, {name: R, line: L1, end: to}, {name: S, line: L2, end: "
               "to}]\n";
        Results r;
        r.folder = folder;
        return r;
    }
};

TEST_F(OneLineFigure, SaysWhichBreakersAreOpenAtTheEndWhichWereAndOfWhichNothingIsKnown) {
    Results r = run_of(3);
    r.signals["breaker.Q.position"] = {"dpc", {0, 1, 2}, {2, 0, 1}};
    r.signals["breaker.R.position"] = {"dpc", {0, 1, 2}, {2, 1, 2}};
    auto const sut = one_line_figure(r);
    ASSERT_TRUE(sut);
    EXPECT_THAT(*sut, HasSubstr("Open: Q. Opened and closed again: R. Not recorded, drawn closed: S."));
    EXPECT_THAT(*sut, HasSubstr(R"(class="breaker opened" data-name="Q")"));
    EXPECT_THAT(*sut, HasSubstr(R"(class="breaker closed" data-name="R")"));
    EXPECT_TRUE(fs::exists(r.folder / "report" / "figures" / "one_line.svg"));
}

TEST_F(OneLineFigure, OfABigGridSaysWhereItIsDrawn) {
    auto const just = one_line_figure(run_of(30)); // 59 elements
    auto const more = one_line_figure(run_of(31)); // 61
    ASSERT_TRUE(just && more);
    EXPECT_THAT(*just, HasSubstr("<svg"));
    EXPECT_THAT(*more, Not(HasSubstr("<svg")));
    EXPECT_THAT(*more, HasSubstr("gridspace monitor"));
}

TEST_F(OneLineFigure, OfARunWithoutANetworkIsNone) {
    auto const sut = one_line_figure(run_of(0));
    ASSERT_TRUE(sut);
    EXPECT_EQ(*sut, "");
    Results nowhere;
    nowhere.folder = "/nonexistent";
    EXPECT_EQ(one_line_figure(nowhere).value_or("?"), "");
}

} // namespace
} // namespace gridspace::launcher
