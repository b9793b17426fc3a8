// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/data/waveform.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace gridspace::ids {

/// Percentages are of max(nominal, running peak).
struct StandingParams {
    int cycle{80};             ///< samples
    double class_percent{11};  ///< how large a standing difference may be that a measuring chain within its classes
                               ///< makes: two transformers 5P (1 % and 60 minutes each), 80 us, 4 % of charging current
    int patience_cycles{3};    ///< a difference that is no standing one yet is learnt after so long
    int learn_cycles{12};      ///< for the reference
    double slack_percent{0.5}; ///< CUSUM: what a cycle may be off the reference
    double alarm_percent_cycles{8}; ///< CUSUM: the sum of what is more
    double forget_cycles{1800};     ///< how slowly the reference follows
};

/// What the two ends of a line differ by all the time: errors of the measuring chain, charging current, or somebody's
/// work. It is the mean of the last cycles at the same point of the cycle, so it needs no model of where it comes from.
/// And whether it moves: the difference as a complex share of the through current, by CUSUM against a reference.
class StandingDifference {
  public:
    explicit StandingDifference(StandingParams const& params);

    struct Input {
        std::int64_t index{0};           ///< of the sample, at least 0
        Abc difference_a{}, current_a{}; ///< of the two ends; of one of them
        double base_a{1}, limit_a{0};    ///< the larger peak; what is a difference
        bool disturbed{false};           ///< both ends see a change: this cycle says nothing about the chain
    };
    /// What is left of the difference: all of it where the standing one is unknown, beyond the classes, or gone.
    Abc const& step(Input const& in);
    void restart();

    [[nodiscard]] double percent() const { return percent_; } ///< amplitude of the largest phase; follows each cycle
    [[nodiscard]] bool beyond_classes() const { return known_ && percent_ > params_.class_percent; }
    [[nodiscard]] bool moved() const { return moved_; }

  private:
    struct Complex {
        double re{0}, im{0};
    };
    struct Phase {
        std::vector<double> standing; ///< A, by the place in the cycle
        Complex difference, current;  ///< sums of this cycle
        double direct{0};
        Complex reference; ///< of difference / current
        double reference_a{0}, reference_direct_a{0};
        double sum{0}; ///< CUSUM
    };
    void begin_cycle(std::int64_t cycle);
    void end_cycle(double base_a);
    void look_for_movement(Phase& phase, double base_a);

    StandingParams params_;
    std::vector<double> cos_, sin_;
    std::array<Phase, 3> phases_;
    Abc remaining_{};
    std::int64_t cycle_{-1};
    int samples_{0}; ///< of this cycle
    int patience_{0}, heavy_{0}, cycles_{0}, quiet_cycles_{0};
    double learnt_base_a_{0};
    bool known_{false}, disturbed_{false}, moved_{false};
    double percent_{0};
};

} // namespace gridspace::ids
