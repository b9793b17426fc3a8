// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/phasor_injection.hpp"
#include "sim/phasor/dae_solver.hpp"
#include "sim/powerflow/branch.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace gridspace::sim::phasor {

/// How the voltage of a bus is found.
struct BusRule {
    enum class Kind {
        balance,   ///< currents add up to zero
        held,      ///< an ideal source: voltage given
        regulated, ///< a generator holds |v| and gives a power
        limited,   ///< such a generator at its reactive limit
        dead,      ///< nothing feeds it
    } kind{Kind::balance};
    Complex v;                        ///< held
    double v_set{1};                  ///< regulated
    double p{0};                      ///< regulated: generated power, p.u.
    double q_min{-1e30}, q_max{1e30}; ///< regulated, limited: reactive power, p.u.
    int at_limit{0};                  ///< limited: 1 at q_max, -1 at q_min
};

/// The equations of network and injections. Unknowns: all injection states, then real and imaginary part of each bus
/// voltage. p.u.
class NetworkDae final : public DaeProblem {
  public:
    NetworkDae(std::vector<std::unique_ptr<PhasorInjection>> const& injections, std::size_t buses);

    /// The network as it is now.
    void set_network(std::vector<Branch> branches, std::vector<Complex> shunts, std::vector<BusRule> rules);

    [[nodiscard]] std::span<double> states_of(std::size_t injection, std::span<double> y) const;
    [[nodiscard]] std::span<double const> states_of(std::size_t injection, std::span<double const> y) const;
    [[nodiscard]] Complex voltage(std::size_t bus, std::span<double const> y) const;
    void set_voltage(std::size_t bus, Complex v, std::span<double> y) const;
    /// Current that leaves the bus into lines, transformers and shunts.
    [[nodiscard]] Complex network_current(std::size_t bus, std::span<double const> y) const;
    /// Current that all injections inject at the bus.
    [[nodiscard]] Complex injected_current(std::size_t bus, double t, std::span<double const> y) const;

    [[nodiscard]] BusRule const& rule(std::size_t bus) const { return rules_[bus]; }
    /// Reactive power of the generators that hold a regulated bus, p.u.
    [[nodiscard]] double regulating_q(std::size_t bus, double t, std::span<double const> y) const;

    [[nodiscard]] std::size_t size() const override { return voltage_start_ + 2 * buses_; }
    [[nodiscard]] std::vector<double> differential() const override;
    void residual(double t, std::span<double const> y, std::span<double const> yp, std::span<double> f) override;
    [[nodiscard]] std::vector<SparsityEntry> sparsity() const override;
    void jacobian(double t, double c, std::span<double const> y, std::span<double const> yp,
                  std::span<double> values) override;
    /// Of the injections, then of the buses: a generator meets its reactive limit, or leaves it.
    [[nodiscard]] std::size_t events() const override { return injections_.size() + buses_; }
    void event_values(double t, std::span<double const> y, std::span<double> g) override;

  private:
    struct RowEntry {
        std::size_t bus;
        Complex y;
    };
    /// Calls emit(row, column, value) for every place of the Jacobian, always in the same order.
    template <class Emit>
    void assemble(double t, double c, std::span<double const> y, Emit const& emit) const;

    std::vector<std::unique_ptr<PhasorInjection>> const& injections_;
    std::size_t buses_;
    std::vector<std::size_t> state_start_;
    std::size_t voltage_start_{0};
    std::vector<std::vector<RowEntry>> rows_;
    std::vector<BusRule> rules_;
    std::vector<std::vector<std::size_t>> injections_at_;
    mutable std::vector<double> scratch_, moved_, slopes_;
};

} // namespace gridspace::sim::phasor
