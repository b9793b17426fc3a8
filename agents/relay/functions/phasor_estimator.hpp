// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/phasor.hpp"

#include <vector>

namespace gridspace::relay {

struct PhasorParams {
    int samples_per_cycle{80}; ///< of the nominal frequency; 4 or more
    /// Time constant, in samples, of a decaying offset that is taken out (the digital mimic filter of Benmouyal,
    /// IEEE Trans. Power Delivery 10 (1995) 2): an offset of exactly this time constant goes to nothing, others nearly.
    /// 0: none is taken out.
    double offset_samples{0};
};

/// Phasors of three phases: full-cycle DFT, whose error away from the nominal frequency is known for a sinusoid and is
/// taken out. Of a sinusoid of frequency f the DFT of N samples gives P S + Q conj(S) (Phadke and Thorp, Synchronized
/// Phasor Measurements, 2008, section 3.2); two real equations give S back, exactly, when f is the frequency that is
/// set. No allocation after construction.
class PhasorEstimator {
  public:
    explicit PhasorEstimator(PhasorParams const& params);

    /// The frequency by which phasors are formed, relative to the nominal one; 0.5 to 1.5.
    void set_frequency(double relative);
    void push(Abc const& sample);
    /// Forgets all samples.
    void clear() { filled_ = 0; }
    [[nodiscard]] bool full() const { return filled_ > params_.samples_per_cycle; }
    /// R.m.s.; angles in the middle of the window, where they do not depend on the frequency that is set. They turn
    /// with the frequency that is there. Only when full().
    [[nodiscard]] Phasors phasors() const;
    [[nodiscard]] PhasorParams const& params() const { return params_; }

  private:
    PhasorParams params_;
    std::vector<Abc> rows_; ///< the window twice, so that the newest samples always lie in one piece
    std::vector<double> cos_, sin_;
    Abc last_{};
    double gain_{1}; ///< of the mimic filter, so that it leaves the nominal frequency's magnitude alone
    double relative_{1};
    Complex own_{1, 0}, image_{0, 0}; ///< P, Q
    Complex after_{1, 0};             ///< takes the filter out, and turns to the middle of the window
    int next_{0}, filled_{0};
};

} // namespace gridspace::relay
