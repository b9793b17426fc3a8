// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/scoring/interval.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace gridspace::ids {

/// What a detector said about one phase of one sample. Any detector: nothing here is ours.
struct ScoredVerdict {
    std::string stream;
    std::int64_t index{0};
    std::uint8_t channel{0};
    double raw_a{0}, forecast_a{0}, accepted_a{0}, limit_a{0};
    bool flagged{false}, open_flagged{false};
};

/// What an attacker did to one phase of one sample.
struct ScoredLabel {
    std::string attack, stream;
    std::int64_t index{0};
    std::uint8_t channel{0};
    double true_a{0}, sent_a{0};
};

/// One attack, as a whole.
struct AttackScore {
    std::string attack;
    std::uint64_t labels{0};        ///< phase-samples that were altered
    std::uint64_t judged{0};        ///< of those, how many a verdict exists for
    Share detected;                 ///< flagged, of the judged
    Share open_detected;            ///< flagged by the open loop, of the judged
    Share open_clear_detected;      ///< of the judged that are clear, see below
    Share clear_detected;           ///< the same for fakes that differ from the truth by more than twice the threshold
    bool seen{false};               ///< flagged at least once
    std::int64_t delay_samples{-1}; ///< from the first altered sample to the first flag at or after it; -1: never
};

struct Score {
    std::uint64_t true_positives{0}, false_positives{0}, true_negatives{0}, false_negatives{0}; ///< phase-samples
    Share false_positive;      ///< of the phase-samples that nobody altered
    Share open_false_positive; ///< the same for the open loop
    std::uint64_t labels_without_verdict{0};
    std::vector<AttackScore> attacks; ///< by name
};

/// Joins verdicts and labels, in whatever order they come. Labels of streams nobody gave verdicts on are counted, not
/// judged.
class Scorer {
  public:
    void add(ScoredVerdict const& verdict);
    void add(ScoredLabel const& label);
    [[nodiscard]] Score score() const;

  private:
    using Key = std::tuple<std::size_t, std::int64_t, std::uint8_t>; ///< stream, sample, phase
    [[nodiscard]] std::size_t number_of(std::string const& stream);
    struct Said {
        double limit_a{0};
        bool flagged{false}, open_flagged{false};
    };
    std::map<std::string, std::size_t> streams_;
    std::map<Key, Said> verdicts_;
    std::map<Key, ScoredLabel> labels_;
};

/// Trips against what really happened; sample indices.
struct TripScore {
    std::uint64_t real_faults{0};
    std::uint64_t tripped{0}; ///< real faults with a trip within the allowed time
    std::uint64_t late_or_blocked{0};
    std::uint64_t false_trips{0};     ///< trips with no real fault before them
    std::vector<std::int64_t> delays; ///< from fault to trip, of those that tripped
};
struct RealFault {
    std::int64_t from{0}, until{0}; ///< a trip in [from, until) is right
};
[[nodiscard]] TripScore score_trips(std::vector<RealFault> const& faults, std::vector<std::int64_t> const& trips);

} // namespace gridspace::ids
