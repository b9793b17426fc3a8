// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <memory>
#include <span>
#include <vector>

namespace gridspace::sim::phasor {

/// Place of a possibly non-zero element of the Jacobian.
struct SparsityEntry {
    int row, column;
};

/// F(t, y, y') = 0 with its Jacobian dF/dy + c dF/dy'.
class DaeProblem {
  public:
    virtual ~DaeProblem() = default;
    [[nodiscard]] virtual std::size_t size() const = 0;
    /// 1 for differential unknowns, 0 for algebraic ones.
    [[nodiscard]] virtual std::vector<double> differential() const = 0;
    virtual void residual(double t, std::span<double const> y, std::span<double const> yp, std::span<double> f) = 0;
    /// All places that jacobian() may fill, in the order of its values; repeated places add up.
    [[nodiscard]] virtual std::vector<SparsityEntry> sparsity() const = 0;
    virtual void jacobian(double t, double c, std::span<double const> y, std::span<double const> yp,
                          std::span<double> values) = 0;
    /// Event functions; the solver stops where one crosses zero.
    [[nodiscard]] virtual std::size_t events() const { return 0; }
    virtual void event_values(double /*t*/, std::span<double const> /*y*/, std::span<double> /*g*/) {}
};

struct DaeOptions {
    double relative_tolerance{1e-8};
    double absolute_tolerance{1e-9};
    std::size_t dense_up_to{40}; ///< unknowns; beyond that KLU
};

/// Follows a problem through time.
class DaeIntegrator {
  public:
    virtual ~DaeIntegrator() = default;
    /// Starts (again) at t: the differential part of y holds; the algebraic part and y' are computed to be consistent.
    [[nodiscard]] virtual Result<void> restart(double t, std::span<double> y, std::span<double> yp) = 0;

    struct Stop {
        double t{0};
        std::vector<int> events; ///< which crossed zero; empty: the time was reached
    };
    /// Integrates to `until`, never beyond, or to an event before it. y and yp are what holds there.
    [[nodiscard]] virtual Result<Stop> advance(double until, std::span<double> y, std::span<double> yp) = 0;
};

/// SUNDIALS IDA with a dense or a KLU linear solver [Hindmarsh et al., ACM TOMS 31(3), 2005].
class DaeSolver final : public DaeIntegrator {
  public:
    DaeSolver(DaeProblem& problem, DaeOptions options);
    ~DaeSolver() override;
    [[nodiscard]] Result<void> restart(double t, std::span<double> y, std::span<double> yp) override;
    [[nodiscard]] Result<Stop> advance(double until, std::span<double> y, std::span<double> yp) override;

    [[nodiscard]] long steps() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace gridspace::sim::phasor
