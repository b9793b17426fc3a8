// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/design.hpp"

#include "common/config/yaml.hpp"
#include "launcher/sweep/overlay.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;
using Combine = Study::Combine;

Parameter listed(std::string const& name, std::vector<std::string> const& values) {
    Parameter p;
    p.name.name = name;
    p.paths = {{"a." + name, {}}};
    for (std::string const& value : values) {
        p.values.push_back(Node::scalar(value));
    }
    return p;
}

Parameter drawn(std::string const& name, Distribution distribution) {
    Parameter p;
    p.name.name = name;
    p.paths = {{"a." + name, {}}};
    p.distribution = distribution;
    return p;
}

Distribution uniform(double low, double high) {
    return {.kind = Distribution::Kind::uniform, .low = low, .high = high};
}

std::vector<std::string> texts(Design const& design) {
    std::vector<std::string> out;
    for (Point const& point : design.points) {
        std::string text;
        for (Node const& value : point) {
            text += (text.empty() ? "" : " ") + cell_text(value);
        }
        out.push_back(text);
    }
    return out;
}

Design make(Study const& study) {
    config::Diagnostics diagnostics;
    Design design = make_design(study, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return design;
}

std::string mistake(Study const& study) {
    config::Diagnostics diagnostics;
    EXPECT_TRUE(make_design(study, diagnostics).points.empty());
    return diagnostics.render();
}

TEST(Design, CrossesEveryValueWithEveryOtherTheLastFastest) {
    Study study;
    study.parameters = {listed("x", {"1", "2"}), listed("y", {"a", "b", "c"})};
    EXPECT_EQ(texts(make(study)), (std::vector<std::string>{"1 a", "1 b", "1 c", "2 a", "2 b", "2 c"}));
}

TEST(Design, ZipsFirstWithFirst) {
    Study study;
    study.combine = Combine::zip;
    study.parameters = {listed("x", {"1", "2"}), listed("y", {"a", "b"})};
    EXPECT_EQ(texts(make(study)), (std::vector<std::string>{"1 a", "2 b"}));
}

TEST(Design, RefusesToZipListsOfDifferentLengths) {
    Study study;
    study.combine = Combine::zip;
    study.parameters = {listed("x", {"1", "2"}), listed("y", {"a"})};
    EXPECT_NE(mistake(study).find("'y' has 1 values, and 'x' has 2"), std::string::npos);
}

TEST(Design, HasOnePointWhereNothingVaries) {
    EXPECT_EQ(make(Study{}).points.size(), 1U);
}

TEST(Design, LatinHypercubeHasOneDrawInEachEquallyLikelyPart) {
    Study study;
    study.sampling = {.latin_hypercube = true, .samples = 50, .seed = 7};
    study.parameters = {drawn("x", uniform(0, 50)), drawn("y", uniform(100, 200))};
    std::set<int> x, y;
    for (Point const& point : make(study).points) {
        x.insert(static_cast<int>(*config::number_of(point[0])));
        y.insert(static_cast<int>((*config::number_of(point[1]) - 100) / 2));
    }
    EXPECT_EQ(x.size(), 50U);
    EXPECT_EQ(y.size(), 50U);
}

TEST(Design, IsTheSameForTheSameSeedAndAnotherForAnother) {
    Study study;
    study.sampling = {.latin_hypercube = true, .samples = 5, .seed = 1};
    study.parameters = {drawn("x", uniform(0, 1))};
    auto const first = texts(make(study)), again = texts(make(study));
    study.sampling.seed = 2;
    EXPECT_EQ(first, again);
    EXPECT_NE(first, texts(make(study)));
}

TEST(Design, AFurtherParameterChangesNoDrawOfTheOthers) {
    Study study;
    study.sampling.samples = 5;
    study.parameters = {drawn("x", uniform(0, 1))};
    Design const alone = make(study);
    study.parameters.insert(study.parameters.begin(), drawn("y", uniform(0, 1)));
    Design const both = make(study);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(alone.points[i][0].text, both.points[i][1].text);
    }
}

TEST(Design, CrossesDrawsAsAWholeWithLists) {
    Study study;
    study.sampling.samples = 3;
    study.parameters = {drawn("x", uniform(0, 1)), listed("y", {"a", "b"})};
    Design const design = make(study);
    ASSERT_EQ(design.points.size(), 6U);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(design.points[i][0].text, design.points[i + 3][0].text);
        EXPECT_EQ(design.points[i][1].text, "a");
    }
}

TEST(Design, ZippedDrawsAreAsManyAsTheListsAreLong) {
    Study study;
    study.combine = Combine::zip;
    study.parameters = {listed("x", {"1", "2", "3"}), drawn("y", uniform(0, 1))};
    EXPECT_EQ(make(study).points.size(), 3U);
}

TEST(Design, RoundsDraws) {
    Study study;
    study.sampling.samples = 20;
    study.parameters = {drawn("x", uniform(0, 10))};
    study.parameters.front().round_to = 0.5;
    for (Point const& point : make(study).points) {
        double const halves = *config::number_of(point[0]) * 2;
        EXPECT_EQ(halves, std::round(halves));
    }
}

TEST(Design, ConditionsLeaveOutPoints) {
    Study study;
    study.parameters = {listed("x", {"1", "2", "3"}), listed("y", {"2", "3"})};
    study.where = {{"vary.x < vary.y", {}}};
    Design const design = make(study);
    EXPECT_EQ(texts(design), (std::vector<std::string>{"1 2", "1 3", "2 3"}));
    EXPECT_EQ(design.left_out, 3U);
}

TEST(Design, SaysWhatIsWrongWithACondition) {
    Study study;
    study.parameters = {listed("speed", {"1", "fast"})};
    study.where = {{"vary.sped > 0", {}}};
    EXPECT_NE(mistake(study).find("uses 'vary.sped', which does not vary"), std::string::npos);
    study.where = {{"vary.speed >", {}}};
    EXPECT_NE(mistake(study).find("cannot be read"), std::string::npos);
    study.where = {{"vary.speed > 0", {}}};
    EXPECT_NE(mistake(study).find("needs numbers, and 'speed' can be 'fast'"), std::string::npos);
    study.parameters = {listed("speed", {"1"})};
    study.where = {{"vary.speed > 5", {}}};
    EXPECT_NE(mistake(study).find("none of the 1 points"), std::string::npos);
}

TEST(Design, RefusesDrawsOfNoNumber) {
    Study study;
    study.parameters = {drawn("x", uniform(0, 1))};
    EXPECT_NE(mistake(study).find("'x' is drawn, and nothing says how often"), std::string::npos);
}

TEST(Design, IsBounded) {
    Study study;
    std::vector<std::string> const many(1000, "1");
    study.parameters = {listed("x", many), listed("y", many), listed("z", many)};
    EXPECT_NE(mistake(study).find("more than 100000 points"), std::string::npos);
    study.parameters.resize(1);
    study.repetitions = 101;
    EXPECT_NE(mistake(study).find("1000 points with 101 repetitions each are more than 100000 runs"),
              std::string::npos);
}

TEST(Distribution, QuantilesAreThoseOfTablesOfStatistics) {
    EXPECT_DOUBLE_EQ(quantile(uniform(2, 4), 0.25), 2.5);
    EXPECT_NEAR(quantile({.kind = Distribution::Kind::normal, .mean = 10, .deviation = 2}, 0.975), 10 + 2 * 1.959963985,
                1e-8);
    EXPECT_NEAR(quantile({.kind = Distribution::Kind::log_uniform, .low = 1, .high = 10000}, 0.5), 100, 1e-9);
    EXPECT_NEAR(quantile({.kind = Distribution::Kind::triangular, .low = 0, .high = 2, .mode = 1}, 0.125), 0.5, 1e-12);
}

TEST(Distribution, ATruncatedNormalOneStaysWithinItsBoundsAndKeepsItsMedianWhereTheyAreSymmetric) {
    Distribution const sut{.kind = Distribution::Kind::normal, .low = -1, .high = 1, .mean = 0, .deviation = 5};
    EXPECT_GE(quantile(sut, 1e-12), -1);
    EXPECT_LE(quantile(sut, 1 - 1e-12), 1);
    EXPECT_NEAR(quantile(sut, 0.5), 0, 1e-12);
}

TEST(Overlay, PutsEveryValueAtItsPathsAndReadsBackAsItWas) {
    Study study;
    study.name = "s";
    study.scenario = "/a b/c.yaml";
    study.set = Node::map();
    study.set.set("processes.monitor", Node{});
    study.parameters = {listed("x", {"1"})};
    study.parameters.front().paths = {{"p.a", {}}, {"p.b.c", {}}};
    study.results = Node::map();
    Node shown = Node::map();
    shown.set("min_of", Node::scalar("bus.*.v_pu"));
    study.results.set("v", shown);
    Node const overlay = overlay_of(study, {Node::scalar("3")}, "7", {"old"});
    std::string const text = overlay_file(study, overlay);
    config::Diagnostics diagnostics;
    auto const read = config::parse_yaml(text, config::make_source("overlay", text), diagnostics);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(read->find("p")->find("a")->text, "3");
    EXPECT_EQ(read->find("p")->find("b")->find("c")->text, "3");
    EXPECT_TRUE(read->find("processes")->find("monitor")->is_null());
    EXPECT_TRUE(read->find("expect")->find("old")->is_null());
    EXPECT_EQ(read->find("expect")->find("v")->find("show_only")->text, "true");
    EXPECT_EQ(read->find("seed")->text, "7");
    EXPECT_EQ(read->find("extends")->text, "/a b/c.yaml");
}

TEST(Overlay, NamesAFileWhereTheStudyNamesItAndLeavesOtherWordsAlone) {
    TemporaryFolder const temporary;
    std::filesystem::path const& folder = temporary.path();
    std::ofstream{folder / "grid.yaml"} << "---\n";
    std::ofstream{folder / "word"} << "\n";
    auto const source =
        std::make_shared<config::SourceText const>(config::SourceText{"study.yaml", folder.string(), {}});
    Study study;
    study.name = "s";
    study.scenario = "/c.yaml";
    study.set = Node::map();
    study.results = Node::map();
    study.parameters = {listed("x", {"1"})};
    study.parameters.front().paths = {{"simulation.network", {}}};
    auto const written = [&](char const* text) {
        return overlay_file(study, overlay_of(study, {Node::scalar(text, {source, 1, 1})}, "", {}));
    };
    EXPECT_THAT(written("grid.yaml"), testing::HasSubstr((folder / "grid.yaml").string()));
    EXPECT_THAT(written("./grid.yaml"), testing::HasSubstr(" \"" + (folder / "grid.yaml").string()));
    EXPECT_THAT(written("other.yaml"), testing::HasSubstr("network: other.yaml"));
    EXPECT_THAT(written("word"), testing::HasSubstr("network: word"));
}

} // namespace
} // namespace gridspace::launcher
