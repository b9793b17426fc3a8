// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/phasor.hpp"

#include <vector>

namespace gridspace::relay {

struct FrequencyParams {
    double nominal_hz{50};
    int samples_per_cycle{80};
    int average_cycles{2}; ///< of the frequency
    int rocof_cycles{5};   ///< over which its rate of change is formed
    double minimum{0};     ///< magnitude of the positive sequence, below which nothing is measured
};

/// Frequency and its rate of change from the turning of the positive-sequence voltage, which in a balanced system has
/// no image at another frequency (Phadke and Thorp 2008, section 3.3): the angle that it gains in a nominal cycle,
/// averaged over whole cycles, and the difference of two averages. No allocation after construction.
class FrequencyEstimator {
  public:
    explicit FrequencyEstimator(FrequencyParams const& params);

    /// The positive sequence of the newest window.
    void push(Complex positive);
    void clear();

    /// What it says belongs to a window of 2 + average_cycles cycles; the rate of change to rocof_cycles more.
    [[nodiscard]] bool has_frequency() const { return measured_ >= average_; }
    [[nodiscard]] bool has_rate() const { return measured_ >= average_ + rate_span_; }
    [[nodiscard]] double hz() const { return hz_; }
    [[nodiscard]] double hz_per_s() const { return hz_per_s_; }
    /// The frequency for phasors, relative to the nominal one: the last one that was steady (all within half a hertz).
    /// In a fault the angle of the voltage jumps, and what would follow from that is no frequency.
    [[nodiscard]] double steady() const { return steady_; }

  private:
    FrequencyParams params_;
    int average_, rate_span_;
    std::vector<Complex> turned_; ///< the last cycle
    std::vector<double> raw_;     ///< frequencies, as many as are averaged
    std::vector<double> means_;   ///< averages, as many as the rate of change spans
    std::size_t turned_next_{0}, raw_next_{0}, means_next_{0};
    int seen_{0}, measured_{0};
    double hz_, hz_per_s_{0}, steady_{1};
};

} // namespace gridspace::relay
