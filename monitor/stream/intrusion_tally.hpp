// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace gridspace::stream {

/// Counts what a detector said about one stream against what an attacker really did, while both are told: verdicts in
/// the order of samples, labels whenever they come. Memory is bounded: a label that comes more than 65,536 samples
/// after its verdict is counted as unscored. A recorded run's report counts in the same way from the whole recording.
/// Pure.
class IntrusionTally {
  public:
    struct Counts {
        std::uint64_t judged{0};         ///< samples of which there was a forecast
        std::uint64_t flagged{0};        ///< of these: in at least one phase
        std::uint64_t forged_judged{0};  ///< samples of which at least one phase was forged
        std::uint64_t forged_flagged{0}; ///< of these: flagged in at least one phase
        std::uint64_t open_flagged{0};   ///< of the judged: flagged by the loop that is not fed its own replacements
        std::uint64_t forged_open_flagged{0}; ///< of the forged: the same
        std::uint64_t fakes{0};               ///< forged values: samples times phases
        std::uint64_t detected{0};            ///< of these: flagged in that phase
        std::uint64_t unscored{0};            ///< fakes that nobody has judged yet
        /// Of the healthy samples, those that were flagged; NaN without any.
        [[nodiscard]] double false_positive_percent() const;
        [[nodiscard]] double open_loop_false_positive_percent() const;
        /// Of the fakes that were judged; NaN without any.
        [[nodiscard]] double detected_percent() const;
    };
    /// `flagged`: bit p is phase p. `open_flagged`: any of them by the open loop.
    void verdict(std::uint64_t index, bool judged, std::uint8_t flagged, bool open_flagged = false);
    void label(std::uint64_t index, std::uint8_t phase);
    [[nodiscard]] Counts const& counts() const { return counts_; }

  private:
    static constexpr std::size_t kSamples = 65536;
    static constexpr std::size_t kLabels = 1'000'000;
    struct Judged {
        std::uint64_t index{UINT64_MAX};
        bool judged{false}, open_flagged{false};
        std::uint8_t flagged{0};
    };
    std::vector<Judged> judged_;                             ///< the newest, by index modulo kSamples
    std::unordered_map<std::uint64_t, std::uint8_t> forged_; ///< phases by index; never iterated over
    Counts counts_;
};

} // namespace gridspace::stream
