// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/fixed_step_solver.hpp"

#include "sim/powerflow/sparse_lu.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim::phasor {
namespace {

constexpr double kGamma = 0.29289321881345247560; ///< 1 - 1/sqrt(2)
constexpr int kMaxIterations = 12;
constexpr double kTolerance = 1e-11;
/// A stage is an implicit Euler step; one of this length (s) leaves differential unknowns where they are.
constexpr double kInstant = 1e-9;

} // namespace

struct FixedStepSolver::Impl {
    DaeProblem& problem;
    double step_s;
    std::size_t n;
    std::vector<double> differential;
    std::vector<SparsityEntry> places;
    std::vector<double> values, f, base, k1, trial, slope, start, g_before, g_after;
    Eigen::SparseMatrix<double> matrix;
    std::vector<Eigen::Triplet<double>> triplets;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> factors;
    double factored_c{0}, t{0};
    bool analysed{false};

    Impl(DaeProblem& p, double h)
        : problem{p}, step_s{h}, n{p.size()}, differential{p.differential()}, places{p.sparsity()},
          values(places.size()), f(n), base(n), k1(n), trial(n), slope(n), start(n), g_before(p.events()),
          g_after(p.events()), matrix(static_cast<int>(n), static_cast<int>(n)), triplets(places.size()) {}

    bool factor(double at, double c) {
        problem.jacobian(at, c, trial, slope, values);
        for (std::size_t i = 0; i < places.size(); ++i) {
            triplets[i] = {places[i].row, places[i].column, values[i]};
        }
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        if (!analysed) {
            factors.analyzePattern(matrix);
            analysed = true;
        }
        factors.factorize(matrix);
        factored_c = c;
        return factors.info() == Eigen::Success;
    }

    /// Solves F(t, Y, (Y - base) c) = 0 for Y from the guess in `trial`; the derivative is left in `slope`.
    bool stage(double at, double c) {
        for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
            for (std::size_t i = 0; i < n; ++i) {
                slope[i] = differential[i] * (trial[i] - base[i]) * c;
            }
            problem.residual(at, trial, slope, f);
            // A fresh Jacobian at the start and when the old one no longer converges.
            if ((iteration == 0 || iteration == 4 || iteration == 8) && !factor(at, c)) {
                return false;
            }
            Eigen::Map<Eigen::VectorXd const> const rest{f.data(), static_cast<Eigen::Index>(n)};
            Eigen::VectorXd const change = factors.solve(rest);
            double largest = 0;
            for (std::size_t i = 0; i < n; ++i) {
                trial[i] -= change[static_cast<Eigen::Index>(i)];
                largest = std::max(largest, std::abs(change[static_cast<Eigen::Index>(i)]) / (1 + std::abs(trial[i])));
            }
            if (!(largest < 1e6)) {
                return false;
            }
            if (largest < kTolerance) {
                for (std::size_t i = 0; i < n; ++i) {
                    slope[i] = differential[i] * (trial[i] - base[i]) * c;
                }
                return true;
            }
        }
        return false;
    }

    /// From `start` at t over h; the result is in `trial`.
    bool step(double h) {
        double const c = 1 / (kGamma * h);
        base = start;
        trial = start;
        if (!stage(t + kGamma * h, c)) {
            return false;
        }
        k1 = slope;
        for (std::size_t i = 0; i < n; ++i) {
            base[i] = start[i] + (1 - kGamma) * h * k1[i];
        }
        return stage(t + h, c);
    }

    void events(double at, std::vector<double>& g) { problem.event_values(at, trial, g); }

    Error gave_up(double at) const {
        return {ExitCode::usage,
                fmt::format("the phasor solver gave up at {} s: a fixed step of {} s has no solution", at, step_s),
                "a shorter step_s, or the adaptive integration, may find one"};
    }
};

FixedStepSolver::FixedStepSolver(DaeProblem& problem, double step_s) : impl_{std::make_unique<Impl>(problem, step_s)} {}
FixedStepSolver::~FixedStepSolver() = default;

Result<void> FixedStepSolver::restart(double t, std::span<double> y, std::span<double> yp) {
    Impl& s = *impl_;
    s.t = t;
    s.base.assign(y.begin(), y.end());
    s.trial = s.base;
    if (!s.stage(t, 1 / kInstant)) {
        return fail(ExitCode::usage, fmt::format("no consistent state at {} s", t));
    }
    for (std::size_t i = 0; i < s.n; ++i) {
        y[i] = s.differential[i] != 0 ? y[i] : s.trial[i];
        s.trial[i] = y[i];
    }
    std::fill(s.slope.begin(), s.slope.end(), 0.0);
    s.problem.residual(t, s.trial, s.slope, s.f); // y' - f(y) with y' = 0
    for (std::size_t i = 0; i < s.n; ++i) {
        yp[i] = s.differential[i] != 0 ? -s.f[i] : 0;
    }
    s.start = s.trial;
    return {};
}

Result<DaeIntegrator::Stop> FixedStepSolver::advance(double until, std::span<double> y, std::span<double> yp) {
    Impl& s = *impl_;
    double const least = 1e-9 * s.step_s;
    while (until - s.t > least) {
        double h = std::min(s.step_s, until - s.t);
        if (until - s.t - h < least) {
            h = until - s.t;
        }
        s.trial = s.start;
        s.events(s.t, s.g_before);
        if (!s.step(h)) {
            return std::unexpected{s.gave_up(s.t)};
        }
        s.events(s.t + h, s.g_after);
        auto const crossed = [&](std::size_t k) { return s.g_before[k] > 0 && s.g_after[k] <= 0; };
        Stop stop{s.t + h, {}};
        bool any = false;
        for (std::size_t k = 0; k < s.g_before.size(); ++k) {
            any = any || crossed(k);
        }
        if (any) {
            // The shortest step after which one has crossed.
            double low = 0, high = h;
            for (int i = 0; i < 40 && high - low > 1e-9 * s.step_s; ++i) {
                double const middle = (low + high) / 2;
                if (!s.step(middle)) {
                    return std::unexpected{s.gave_up(s.t)};
                }
                s.events(s.t + middle, s.g_after);
                bool some = false;
                for (std::size_t k = 0; k < s.g_before.size(); ++k) {
                    some = some || crossed(k);
                }
                (some ? high : low) = middle;
            }
            h = high;
            if (!s.step(h)) {
                return std::unexpected{s.gave_up(s.t)};
            }
            s.events(s.t + h, s.g_after);
            for (std::size_t k = 0; k < s.g_before.size(); ++k) {
                if (crossed(k)) {
                    stop.events.push_back(static_cast<int>(k));
                }
            }
        }
        s.t = std::abs(until - s.t - h) < least ? until : s.t + h;
        stop.t = s.t;
        s.start = s.trial;
        std::copy(s.trial.begin(), s.trial.end(), y.begin());
        std::copy(s.slope.begin(), s.slope.end(), yp.begin());
        if (!stop.events.empty()) {
            return stop;
        }
    }
    return Stop{until, {}};
}

} // namespace gridspace::sim::phasor
