// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_window.hpp"
#include "common/random.hpp"
#include "common/result.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::attacker {

using Abc = std::array<double, 3>;

/// What an attack does to the values of a stream. Lengths are in samples.
struct SampleAttackParams {
    enum class Kind {
        random,     ///< each altered sample is drawn from [low_a, high_a]
        bias,       ///< + bias_a
        scale,      ///< x factor
        ramp,       ///< x (1 + ramp_per_cycle * cycles since the start)
        replay,     ///< what was there `delay` samples ago
        freeze,     ///< the last true value before the attack
        masquerade, ///< a fault that is not there: + peak_a (cos(w t + angle) - cos(angle) e^(-t/tau)), zero at the
                    ///< start
        clock,      ///< a clock that runs behind: the current of offset_s + drift * t ago, under the count of now
        recording,  ///< what was recorded elsewhere, from its first sample on, again and again
    };
    std::string name;
    Kind kind{Kind::random};
    std::uint8_t channels{1};        ///< bit 0: phase a, 1: b, 2: c
    std::int64_t from{0}, until{0};  ///< sample indices; `until` is not included
    std::int64_t every{0}, times{1}; ///< the window again, so many times in all
    std::int64_t ramp{0};            ///< samples from the truth to the full fake
    std::optional<double> above_a;   ///< begins within the window when an attacked current is larger
    bool waits{false};               ///< begins within the window when trigger() was called

    enum class Spacing { every, random };
    Spacing spacing{Spacing::every}; ///< every: all samples of the window; random: `count` single ones
    std::int64_t count{0}, min_gap{1};

    double low_a{0}, high_a{0};
    double min_error_a{0}; ///< random: how far a fake is from the truth at least; less would not be a fake
    double bias_a{0}, factor{1}, ramp_per_cycle{0};
    std::int64_t delay{160};
    double peak_a{0}, angle_deg{0}, tau_s{0.02};
    double offset_s{0}, drift{0}; ///< clock
    std::vector<Abc> recording;   ///< A, at rate_hz
    double rate_hz{4800}, frequency_hz{60};
};

/// One phase of one sample, for the evaluation of detectors.
struct Label {
    std::int64_t index{0};
    std::uint8_t channel{0};
    double true_a{0}, sent_a{0};
};

/// Alters samples as they pass. The same seed and parameters alter the same samples in the same way. No allocation per
/// sample.
class SampleAttack {
  public:
    /// An error when the window is empty, the samples do not fit into it, or a fake cannot be far enough from the
    /// truth.
    [[nodiscard]] static Result<SampleAttack> create(SampleAttackParams params, std::uint64_t seed);

    struct Outcome {
        Abc sent_a{};
        std::uint8_t altered{0}; ///< bits as in `channels`; a value that happens to stay the same is not altered
    };
    /// Takes the true sample of each index, in order, attacked or not.
    [[nodiscard]] Outcome apply(std::int64_t index, Abc const& true_a);

    /// What it waits for has come: it begins at the next sample, if that is within a window.
    void trigger() { triggered_ = params_.waits; }

    [[nodiscard]] SampleAttackParams const& params() const { return params_; }
    [[nodiscard]] std::vector<std::int64_t> const& chosen() const { return chosen_; } ///< spacing random: the samples
    [[nodiscard]] std::uint64_t altered() const { return altered_; }

  private:
    SampleAttack(SampleAttackParams params, std::uint64_t seed);
    [[nodiscard]] std::optional<std::int64_t> due(std::int64_t index, Abc const& true_a);
    [[nodiscard]] double fake(std::int64_t index, std::int64_t start, std::size_t phase, double true_a);
    [[nodiscard]] double late(std::int64_t index, std::int64_t start, std::size_t phase, double true_a) const;
    [[nodiscard]] double draw(double true_a);

    SampleAttackParams params_;
    AttackWindow window_;
    Random random_;
    std::vector<std::int64_t> chosen_;
    std::size_t next_chosen_{0};
    std::vector<Abc> past_; ///< ring of the last true samples: `delay` of them, or what the slowest clock needs
    std::size_t past_next_{0}, past_filled_{0};
    Abc before_{};
    bool triggered_{false}; ///< since the last sample
    std::uint64_t altered_{0};
};

/// Calls `take(Label)` for each altered phase.
template <class Take>
void labels_of(std::int64_t index, Abc const& true_a, SampleAttack::Outcome const& outcome, Take&& take) {
    for (std::uint8_t p = 0; p < 3; ++p) {
        if ((outcome.altered & (1U << p)) != 0) {
            take(Label{index, p, true_a[p], outcome.sent_a[p]});
        }
    }
}

} // namespace gridspace::attacker
