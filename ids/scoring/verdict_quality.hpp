// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gridspace::ids {

/// What a detector said about one sample, and what is true.
struct Judgement {
    std::uint32_t block{0}; ///< samples of a block belong together: neighbours in time are no independent evidence
    bool altered{false}, flagged{false};
    double score{0}; ///< higher: more suspicious; only where all have one
};

/// A figure (0 to 1) with its 95 % interval. Nothing where nothing can be counted.
struct Estimate {
    std::optional<double> value, low, high;
};

struct RocPointOfScores {
    double threshold{0}; ///< flagged from this score on
    double false_positive_rate{0}, recall{0};
};

struct VerdictQuality {
    std::uint64_t true_positives{0}, false_positives{0}, true_negatives{0}, false_negatives{0};
    Estimate precision, recall, f1, false_positive_rate, auc;
    std::vector<RocPointOfScores> roc; ///< from none flagged to all, at most about 200 points; empty without scores
};

/// Precision, recall, F1 and false positive rate, and with scores the area below the ROC curve: the probability that an
/// altered sample has a higher score than a genuine one, ties counting half (Mann-Whitney). Intervals: percentiles of a
/// bootstrap that draws blocks with replacement (Efron; blocks after Kuensch), `resamples` times. A draw costs the
/// number of blocks, and for the area a term for each block between two changes from altered to genuine in the order of
/// the scores. Where these are more than `most_shares`, neighbours in that order are put together for the interval (not
/// for the figure), and it is moved by what that changes of the figure.
[[nodiscard]] VerdictQuality verdict_quality(std::vector<Judgement> judgements, bool has_scores, std::uint64_t seed,
                                             int resamples = 1000, std::size_t most_shares = 2'000'000);

} // namespace gridspace::ids
