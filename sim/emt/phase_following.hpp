// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>

namespace gridspace::sim::emt {

/// Three single-phase current sources that hold powers phase by phase: what a load draws beyond a constant impedance in
/// an unbalanced network. Each phase follows its own voltage v with a second-order generalised integrator, x1' = w (k
/// (v
/// - x1) - x2), x2' = w x1, whose x1 + j x2 is the voltage's rotating phasor [Ciobotaru et al., PESC 2006], and injects
/// Re(Y (x1 + j x2)), Y = 2 conj(S) / |v|^2, with a first-order lag on Y and |v|.
class PhaseFollowing {
  public:
    static constexpr double kGain = 1.41421356237309505; ///< k: damping 0.707
    static constexpr double kAdmittanceLagS = 1e-3;
    static constexpr double kVoltageLagS = 5e-3;

    PhaseFollowing(double frequency_hz, double nominal_peak_v);

    using Powers = std::array<std::complex<double>, 3>;
    /// Steady state at voltage phasors v (peak, by phase): the current phasors for powers (W, var) into the network.
    [[nodiscard]] std::array<std::complex<double>, 3> start(std::array<std::complex<double>, 3> const& v,
                                                            Powers const& power);
    /// Filtered voltage of a phase, p.u. of nominal.
    [[nodiscard]] double voltage_pu(std::size_t phase) const { return phases_[phase].size / nominal_; }
    /// Currents into the network for a step that ends h from now.
    [[nodiscard]] std::array<double, 3> currents(double h);
    /// After the step, with its terminal voltages (V) and the powers that are wanted from now on.
    void step(std::array<double, 3> const& v, Powers const& power, double h);
    /// Blocks at once, until resume(): back at voltage phasors v as in start(), with currents from zero.
    void trip() { tripped_ = true; }
    void resume(std::array<std::complex<double>, 3> const& v) {
        (void)start(v, {});
        tripped_ = false;
    }
    [[nodiscard]] bool tripped() const { return tripped_; }

  private:
    struct Phase {
        double v{0}, x1{0}, x2{0}, size{0};
        std::complex<double> admittance;
    };
    [[nodiscard]] std::complex<double> wanted(Phase const& p, std::complex<double> power) const;
    void use_step(double h);
    double w_, nominal_;
    double h_{0}, cos_{1}, sin_{0}, tan_half_{0}; ///< of the angle of a step
    std::array<Phase, 3> phases_{};
    bool tripped_{false};
};

} // namespace gridspace::sim::emt
