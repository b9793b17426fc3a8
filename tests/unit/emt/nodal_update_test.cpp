// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Low-rank changes of a factored system against a fresh factorisation.
#include "sim/emt/nodal_system.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace gridspace::sim::emt {
namespace {

constexpr double kStep = 1.0 / 48000;

/// A chain of buses behind a source, with two faults and three cores; `buses` decides whether the system is dense.
struct Grid {
    Circuit c;
    SwitchBits bits;
    explicit Grid(int buses) {
        int last = c.add_triple("source");
        c.sources.push_back({last, 1000, 0, 60, {}, "S"});
        for (int b = 0; b < buses; ++b) {
            int const bus = c.add_triple("bus");
            c.rl.push_back({last, bus, PhaseMatrix::sequence(0.1, 0.3), PhaseMatrix::sequence(1e-3, 3e-3)});
            c.rl.push_back({bus, kEarth, PhaseMatrix::sequence(50, 50), {}});
            last = bus;
        }
        c.faults.push_back({last, 0, {true, true, true}, true, "near"});
        c.faults.push_back({6, 0.5, {false, true, true}, false, "far"});
        for (int k = 0; k < 3; ++k) {
            c.cores.push_back({{last + k, last + (k + 1) % 3, 0, 0}, {1, -1, 0, 0}, 10, 0.1, 5});
        }
        bits.faulted.assign(2, {false, false, false});
        bits.segment.assign(3, 0);
    }
};

/// The largest difference between both ways to solve, over the largest value.
double difference(Grid const& grid, SwitchBits const& to, bool& updated) {
    StepCoefficients coefficients;
    fill_coefficients(grid.c, kStep, coefficients);
    auto const base = make_system(grid.c, grid.bits, coefficients);
    auto const fresh = make_system(grid.c, to, coefficients);
    EXPECT_TRUE(base && fresh);
    auto const changed = update_system(grid.c, *base, to);
    updated = changed != nullptr;
    if (!updated) {
        return 0;
    }
    auto const n = static_cast<std::size_t>((*fresh)->topology.unknowns);
    std::mt19937 random{7};
    std::uniform_real_distribution<double> uniform{-1, 1};
    double worst = 0, largest = 0;
    for (int trial = 0; trial < 5; ++trial) {
        std::vector<double> b(n), x(n), y(n);
        for (double& value : b) {
            value = uniform(random);
        }
        std::vector<double> spoilt = b;
        (*fresh)->solve(spoilt.data(), x.data());
        spoilt = b;
        changed->solve(spoilt.data(), y.data());
        if (changed->dense) {
            changed->add_column(static_cast<int>(n / 2), 0.7, y.data());
            (*fresh)->add_column(static_cast<int>(n / 2), 0.7, x.data());
        }
        for (std::size_t i = 0; i < n; ++i) {
            worst = std::max(worst, std::abs(x[i] - y[i]));
            largest = std::max(largest, std::abs(x[i]));
        }
    }
    return worst / largest;
}

TEST(NodalUpdate, CoresThatAreSaturatedTheOtherWayRoundHaveTheSameSystem) {
    Grid grid{3};
    grid.bits.segment = {1, 0, -1};
    SwitchBits to = grid.bits;
    to.segment = {-1, 0, 1};
    bool updated = false;
    EXPECT_EQ(difference(grid, to, updated), 0);
    EXPECT_TRUE(updated);
}

TEST(NodalUpdate, SolvesFaultsAndSaturatedCoresAsAFreshFactorisationDoes) {
    for (int const buses : {3, 60}) {
        Grid const grid{buses};
        auto const check = [&](auto const& change) {
            SwitchBits to = grid.bits;
            change(to);
            bool updated = false;
            EXPECT_LT(difference(grid, to, updated), 1e-10) << buses;
            EXPECT_TRUE(updated) << buses;
        };
        check([](SwitchBits& b) { b.faulted[0] = {true, true, true}; });
        check([](SwitchBits& b) { b.faulted[0] = {false, true, false}; });
        check([](SwitchBits& b) { b.faulted[1] = {false, true, true}; });
        check([](SwitchBits& b) { b.segment = {1, 0, -1}; });
        check([](SwitchBits& b) {
            b.faulted[0] = {true, false, false};
            b.segment = {1, 1, 1};
        });
    }
}

TEST(NodalUpdate, RefusesWhatItIsNotFor) {
    Grid grid{3};
    bool updated = true;
    SwitchBits to = grid.bits;
    to.faulted = {{true, true, true}, {false, true, true}};
    to.segment = {1, 0, 0}; // seven columns
    (void)difference(grid, to, updated);
    EXPECT_FALSE(updated);
    grid.c.switches.push_back({3, 6, {false, false, false}, {}, "CB"});
    grid.bits.closed = {{false, false, false}};
    to = grid.bits;
    to.closed = {{true, false, false}};
    (void)difference(grid, to, updated);
    EXPECT_FALSE(updated);
}

TEST(NodalUpdate, RefusesToCutAPartOffFromEarth) {
    Circuit c; // a resistor between two triples, earthed by a fault only
    int const a = c.add_triple("a"), b = c.add_triple("b");
    c.rl.push_back({a, b, PhaseMatrix::sequence(1, 1), {}});
    c.faults.push_back({b, 1, {true, true, true}, true, "f"});
    SwitchBits on, off;
    on.faulted = {{true, true, true}};
    off.faulted = {{false, false, false}};
    StepCoefficients coefficients;
    fill_coefficients(c, kStep, coefficients);
    auto const base = make_system(c, on, coefficients);
    ASSERT_TRUE(base.has_value());
    EXPECT_EQ(update_system(c, *base, off), nullptr);
}

} // namespace
} // namespace gridspace::sim::emt
