// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/scoring/scorer.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::ids {

Share share_of(std::uint64_t count, std::uint64_t of) {
    Share out{count, of, 0, 0, 100};
    if (of == 0) {
        return out;
    }
    double const n = static_cast<double>(of), p = static_cast<double>(count) / n, z = 1.959963984540054;
    double const middle = (p + z * z / (2 * n)) / (1 + z * z / n);
    double const half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
    out.percent = 100 * p;
    out.low_percent = count == 0 ? 0 : 100 * std::max(0.0, middle - half);
    out.high_percent = count == of ? 100 : count == 0 ? std::min(100.0, 300 / n) : 100 * std::min(1.0, middle + half);
    return out;
}

std::size_t Scorer::number_of(std::string const& stream) {
    return streams_.try_emplace(stream, streams_.size()).first->second;
}

void Scorer::add(ScoredVerdict const& v) {
    Key const key{number_of(v.stream), v.index, v.channel};
    verdicts_.insert_or_assign(verdicts_.end(), key, Said{v.limit_a, v.flagged, v.open_flagged}); // mostly in order
}

void Scorer::add(ScoredLabel const& l) {
    labels_[{number_of(l.stream), l.index, l.channel}] = l;
}

Score Scorer::score() const {
    Score out;
    std::uint64_t healthy = 0, open_flagged = 0;
    for (auto const& [key, said] : verdicts_) {
        if (labels_.contains(key)) {
            (said.flagged ? out.true_positives : out.false_negatives) += 1;
        } else {
            (said.flagged ? out.false_positives : out.true_negatives) += 1;
            open_flagged += said.open_flagged ? 1U : 0U;
            ++healthy;
        }
    }
    out.false_positive = share_of(out.false_positives, healthy);
    out.open_false_positive = share_of(open_flagged, healthy);

    struct Sum {
        AttackScore score;
        std::uint64_t flagged{0}, open_flagged{0}, clear{0}, clear_flagged{0}, open_clear_flagged{0};
        std::map<std::string, std::int64_t> first; ///< altered sample, by stream
    };
    std::map<std::string, Sum> attacks;
    for (auto const& [key, label] : labels_) {
        Sum& sum = attacks[label.attack];
        ++sum.score.labels;
        auto const [at, is_new] = sum.first.try_emplace(label.stream, label.index);
        at->second = std::min(at->second, label.index);
        auto const said = verdicts_.find(key);
        if (said == verdicts_.end()) {
            ++out.labels_without_verdict;
            continue;
        }
        ++sum.score.judged;
        sum.flagged += said->second.flagged ? 1U : 0U;
        sum.open_flagged += said->second.open_flagged ? 1U : 0U;
        if (std::fabs(label.sent_a - label.true_a) > 2 * said->second.limit_a) {
            ++sum.clear;
            sum.clear_flagged += said->second.flagged ? 1U : 0U;
            sum.open_clear_flagged += said->second.open_flagged ? 1U : 0U;
        }
        if (said->second.flagged && (!sum.score.seen || label.index - at->second < sum.score.delay_samples)) {
            sum.score.seen = true;
            sum.score.delay_samples = label.index - at->second;
        }
    }
    for (auto& [name, sum] : attacks) {
        sum.score.attack = name;
        sum.score.detected = share_of(sum.flagged, sum.score.judged);
        sum.score.open_detected = share_of(sum.open_flagged, sum.score.judged);
        sum.score.open_clear_detected = share_of(sum.open_clear_flagged, sum.clear);
        sum.score.clear_detected = share_of(sum.clear_flagged, sum.clear);
        out.attacks.push_back(sum.score);
    }
    return out;
}

TripScore score_trips(std::vector<RealFault> const& faults, std::vector<std::int64_t> const& trips) {
    TripScore out;
    out.real_faults = faults.size();
    for (RealFault const& fault : faults) {
        std::int64_t first = -1;
        for (std::int64_t const t : trips) {
            if (t >= fault.from && t < fault.until && (first < 0 || t < first)) {
                first = t;
            }
        }
        if (first >= 0) {
            ++out.tripped;
            out.delays.push_back(first - fault.from);
        } else {
            ++out.late_or_blocked;
        }
    }
    for (std::int64_t const t : trips) {
        out.false_trips +=
            std::none_of(faults.begin(), faults.end(), [&](RealFault const& f) { return t >= f.from && t < f.until; })
                ? 1U
                : 0U;
    }
    return out;
}

} // namespace gridspace::ids
