// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sim/network/matlab_case.hpp"
#include "sim/network/matpower.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

MatlabCase read(std::string_view text, config::Diagnostics& diagnostics) {
    return read_matlab_case(text, config::make_source("c.m", text), diagnostics);
}

TEST(MatlabCase, ReadsScalarsMatricesCommentsAndContinuations) {
    config::Diagnostics diagnostics;
    MatlabCase const sut =
        read("function mpc = case2\n%% a comment = [1\nmpc.version = '2';\nmpc.baseMVA = 100.0; % MVA\n"
             "mpc.bus = [\n\t1 3 0 -1.5e1; % slack\n\t2, 1, 90, 30\n];\nmpc.gen = [ 1 72.3 ...\n 27 ];\n"
             "mpc.bus_name = {\n'one; ]';\n'two'};\n",
             diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(sut.name, "case2");
    EXPECT_EQ(sut.scalars.at("baseMVA"), 100);
    EXPECT_EQ(sut.matrices.at("bus").rows, (std::vector<std::vector<double>>{{1, 3, 0, -15}, {2, 1, 90, 30}}));
    EXPECT_EQ(sut.matrices.at("bus").line, 5);
    EXPECT_EQ(sut.matrices.at("gen").rows, (std::vector<std::vector<double>>{{1, 72.3, 27}}));
}

TEST(MatlabCase, ReadsBlockCommentsInfinityAndTheEndOfAFunction) {
    config::Diagnostics diagnostics;
    MatlabCase const sut =
        read("function mpc = c\n%{\nmpc.bus = [9 9];\n  %{\nnested\n  %}\n%}\nmpc.gen = [1 -Inf Inf 1e-3,+2];\r\n"
             "mpc.bus = [1 3;2 1]; mpc.baseMVA = 50\nend\n",
             diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(sut.matrices.at("gen").rows, (std::vector<std::vector<double>>{{1, -HUGE_VAL, HUGE_VAL, 1e-3, 2}}));
    EXPECT_EQ(sut.matrices.at("bus").rows, (std::vector<std::vector<double>>{{1, 3}, {2, 1}}));
    EXPECT_EQ(sut.scalars.at("baseMVA"), 50);
}

TEST(MatlabCase, KnowsTheLineOfEachRow) {
    config::Diagnostics diagnostics;
    MatlabCase const sut = read("mpc.bus = [ 1 2 ...\n 3\n% a comment\n\n 4 5 6; 7 8 9\n];\n", diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(sut.matrices.at("bus").rows.size(), 3U);
    EXPECT_EQ(sut.matrices.at("bus").row_lines, (std::vector<int>{1, 5, 5}));
}

TEST(MatlabCase, RefusesNestingThatWouldOverflowTheStack) {
    for (std::string const& part : {std::string(100'000, '('), std::string(100'000, '-'), std::string(100'000, '[')}) {
        config::Diagnostics diagnostics;
        (void)read("mpc.baseMVA = " + part + "1\n", diagnostics);
        EXPECT_EQ(diagnostics.errors(), 1);
    }
}

TEST(MatlabCase, FollowsTheUnitConversionsOfDistributionCases) {
    config::Diagnostics diagnostics;
    MatlabCase const sut = read(
        "mpc.baseMVA = 10;\nmpc.bus = [1 3 100 60 0 0 1 1 0 12.66];\nmpc.branch = [1 2 0.5 0.25 0];\n"
        "[PQ, PV, REF, NONE, BUS_I, BUS_TYPE, PD, QD] = idx_bus;\n[F_BUS, T_BUS, BR_R, BR_X, ...\n BR_B] = idx_brch;\n"
        "Vbase = mpc.bus(1, BASE_KV) * 1e3;      %% in Volts\nSbase = mpc.baseMVA * 1e6;\n"
        "mpc.branch(:, [BR_R BR_X]) = mpc.branch(:, [BR_R BR_X]) / (Vbase^2 / Sbase);\n"
        "mpc.bus(:, [PD, QD]) = mpc.bus(:, [PD, QD]) / 1e3;\n"
        "pf = 0.8;\nmpc.bus(:, QD) = mpc.bus(:, PD) * sin(acos(pf)) / pf;\n",
        diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_DOUBLE_EQ(sut.matrices.at("bus").rows[0][2], 0.1);
    EXPECT_NEAR(sut.matrices.at("bus").rows[0][3], 0.075, 1e-15);
    EXPECT_NEAR(sut.matrices.at("branch").rows[0][2], 0.5 / (12660.0 * 12660 / 10e6), 1e-15);
}

TEST(MatlabCase, SpacesAndSignsInsideBracketsSeparate) {
    config::Diagnostics diagnostics;
    MatlabCase const sut = read("mpc.bus = [1 -2 +3 4 - 1 2*3];\n", diagnostics);
    EXPECT_EQ(sut.matrices.at("bus").rows, (std::vector<std::vector<double>>{{1, -2, 3, 3, 6}}));
}

TEST(MatlabCase, WhatItDoesNotUnderstandIsAnErrorWithALine) {
    config::Diagnostics diagnostics;
    (void)read("mpc.baseMVA = 100;\nif mpc.baseMVA > 1\n x = 2;\nend\nmpc.gen(:, 99) = 1;\nmpc.bus = [1 2; 3];\n",
               diagnostics);
    EXPECT_GE(diagnostics.errors(), 3);
    EXPECT_EQ(diagnostics.sorted()[0].where.line, 2);
}

TEST(MatlabCase, ASelectionOfNothingIsAnError) {
    for (char const* text :
         {"mpc.bus=[1 3;2 1];\nmpc.bus=mpc.bus([],:);\n", "mpc.bus=[1 3;2 1];\nx=[mpc.bus([],:)];\n"}) {
        config::Diagnostics diagnostics;
        (void)read(text, diagnostics);
        EXPECT_EQ(diagnostics.errors(), 1) << text;
    }
}

} // namespace
} // namespace gridspace::sim
