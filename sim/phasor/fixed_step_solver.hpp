// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/phasor/dae_solver.hpp"

namespace gridspace::sim::phasor {

/// Steps of a fixed length with a bounded number of Newton iterations: the same work in every step, for real time. The
/// two-stage singly diagonally implicit Runge-Kutta method of order 2 [Alexander, SIAM J. Numer. Anal. 14(6), 1977]:
/// L-stable, and the algebraic equations hold at the end of each step.
class FixedStepSolver final : public DaeIntegrator {
  public:
    /// Steps are `step_s` long, shorter only at an event or at the end of advance().
    FixedStepSolver(DaeProblem& problem, double step_s);
    ~FixedStepSolver() override;
    [[nodiscard]] Result<void> restart(double t, std::span<double> y, std::span<double> yp) override;
    [[nodiscard]] Result<Stop> advance(double until, std::span<double> y, std::span<double> yp) override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace gridspace::sim::phasor
