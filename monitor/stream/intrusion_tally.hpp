// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gridspace::stream {

/// Counts what a detector said about one stream against what an attacker really did, while both are published: verdicts
/// in the order of samples, labels whenever they come. Memory is bounded: a label that comes more than 65,536 samples
/// after its verdict is counted as unscored. A recorded run's report counts in the same way from the whole recording.
/// Pure.
class IntrusionTally {
  public:
    /// All in phase-samples: one value of one phase.
    struct Counts {
        std::uint64_t judged{0};              ///< of which there was a forecast
        std::uint64_t flagged{0};             ///< of these
        std::uint64_t open_flagged{0};        ///< of the judged: by the loop that is not fed its own replacements
        std::uint64_t fakes{0};               ///< forged, judged or not
        std::uint64_t forged_judged{0};       ///< of the fakes
        std::uint64_t detected{0};            ///< of these: flagged
        std::uint64_t forged_open_flagged{0}; ///< of these: flagged by that other loop
        [[nodiscard]] std::uint64_t false_positives() const { return flagged - detected; }
        [[nodiscard]] std::uint64_t unscored() const { return fakes - forged_judged; } ///< nobody has judged them yet
        /// Of the healthy ones that were judged, those that were flagged; NaN without any.
        [[nodiscard]] double false_positive_percent() const;
        [[nodiscard]] double open_loop_false_positive_percent() const;
        /// Of the fakes that were judged; NaN without any.
        [[nodiscard]] double detected_percent() const;
    };
    /// Of one sample: bit p is phase p.
    struct Phases {
        std::uint8_t judged{0}, flagged{0}, open_flagged{0};
    };
    void verdict(std::uint64_t index, Phases said);
    void label(std::uint64_t index, std::uint8_t phase);
    [[nodiscard]] Counts const& counts() const { return counts_; }

  private:
    static constexpr std::size_t kSamples = 65536;
    static constexpr std::size_t kLabels = 1'000'000;
    struct Judged {
        std::uint64_t index{UINT64_MAX};
        Phases said;
    };
    void count_forged(std::uint8_t phases, Phases const& said);
    std::vector<Judged> judged_;                             ///< the newest, by index modulo kSamples
    std::unordered_map<std::uint64_t, std::uint8_t> forged_; ///< phases by index; never iterated over
    Counts counts_;
};

} // namespace gridspace::stream
