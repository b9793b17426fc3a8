// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/phasor_injection.hpp"
#include "sim/network/network.hpp"

namespace gridspace::sim::phasor {

/// Ideal source behind an impedance.
class SourceInjection final : public PhasorInjection {
  public:
    SourceInjection(Network const& network, Source const& source, std::size_t bus);
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    /// From `t` on; the phase goes on.
    void change(double t, std::string_view quantity, double value);

  private:
    [[nodiscard]] Complex emf(double t) const;
    std::string name_;
    double base_kva_, nominal_hz_, voltage_pu_;
    double angle_rad_, since_s_{0}, slip_rad_s_{0}; ///< at `since_s_`, and how fast it turns against the reference
    Complex admittance_;
};

/// Generator with given powers (role pq; pv in quasi-static runs is a held voltage, see PhasorEngine).
class GivenPower final : public PowerInjection {
  public:
    GivenPower(Generator const& generator, std::size_t bus, double base_kva);
    bool set(std::string_view quantity, double value) override;

  private:
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override;
    Complex power_;
    double rating_;
};

} // namespace gridspace::sim::phasor
