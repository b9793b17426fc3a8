// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/scoring/verdict_quality.hpp"

#include "common/nearest_rank.hpp"
#include "common/random.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace gridspace::ids {
namespace {

enum Figure : std::uint8_t { kPrecision, kRecall, kF1, kFalsePositiveRate, kAuc };
using Figures = std::array<std::optional<double>, 5>;

struct Counts {
    double tp{0}, fp{0}, tn{0}, fn{0};
    void add(Counts const& other, double times) {
        tp += times * other.tp;
        fp += times * other.fp;
        tn += times * other.tn;
        fn += times * other.fn;
    }
};

std::optional<double> ratio(double of, double all) {
    return all > 0 ? std::optional{of / all} : std::nullopt;
}

/// How many altered and genuine judgements of a block stand at one place in the order of the scores.
struct ScoreShare {
    std::uint32_t place{0}, block{0};
    double altered{0}, genuine{0};
};

/// The area of judgements whose blocks were drawn so often; `shares` by place.
std::optional<double> auc(std::vector<ScoreShare> const& shares, std::vector<double> const& times) {
    double below = 0, pairs = 0, altered_all = 0;
    for (std::size_t i = 0; i < shares.size();) {
        double genuine = 0, altered = 0;
        std::uint32_t const place = shares[i].place;
        for (; i < shares.size() && shares[i].place == place; ++i) {
            genuine += times[shares[i].block] * shares[i].genuine;
            altered += times[shares[i].block] * shares[i].altered;
        }
        pairs += altered * (below + genuine / 2);
        below += genuine;
        altered_all += altered;
    }
    return ratio(pairs, below * altered_all);
}

/// Judgements in the order of their scores, as shares. Where altered and genuine ones do not take turns, the order
/// among them says nothing about the area, so they stand at one place; equal scores do too. With `mass` > 0 a place
/// goes on until it holds so much of all altered and of all genuine ones together (of 2): the area is not exact then.
std::vector<ScoreShare> shares_of(std::vector<Judgement> const& sorted, std::uint32_t blocks, double mass) {
    auto const altered_all = static_cast<double>(std::max<std::ptrdiff_t>(
        1, std::count_if(sorted.begin(), sorted.end(), [](auto const& j) { return j.altered; })));
    double const genuine_all = std::max(1.0, static_cast<double>(sorted.size()) - altered_all);
    std::vector<ScoreShare> out;
    std::vector<std::size_t> at(blocks, SIZE_MAX); ///< of a block in `out`, at the current place
    std::size_t begin = 0;
    std::uint32_t place = 0;
    bool has_altered = false, has_genuine = false;
    double held = 0;
    for (std::size_t i = 0; i < sorted.size();) {
        std::size_t j = i;
        bool altered = false, genuine = false;
        for (; j < sorted.size() && sorted[j].score == sorted[i].score; ++j) {
            (sorted[j].altered ? altered : genuine) = true;
        }
        bool const one_kind = !((has_altered || altered) && (has_genuine || genuine));
        if (i > 0 && !one_kind && held >= mass) {
            for (std::size_t k = begin; k < out.size(); ++k) {
                at[out[k].block] = SIZE_MAX;
            }
            begin = out.size();
            ++place;
            has_altered = has_genuine = false;
            held = 0;
        }
        has_altered = has_altered || altered;
        has_genuine = has_genuine || genuine;
        for (; i < j; ++i) {
            std::size_t& index = at[sorted[i].block];
            if (index == SIZE_MAX) {
                index = out.size();
                out.push_back({place, sorted[i].block, 0, 0});
            }
            (sorted[i].altered ? out[index].altered : out[index].genuine) += 1;
            held += sorted[i].altered ? 1 / altered_all : 1 / genuine_all;
        }
    }
    return out;
}

Figures figures_of(Counts const& c) {
    return {ratio(c.tp, c.tp + c.fp), ratio(c.tp, c.tp + c.fn), ratio(2 * c.tp, 2 * c.tp + c.fp + c.fn),
            ratio(c.fp, c.fp + c.tn), std::nullopt};
}

std::vector<RocPointOfScores> roc(std::vector<Judgement> const& sorted) {
    constexpr std::size_t kPoints = 200;
    double const altered =
        static_cast<double>(std::count_if(sorted.begin(), sorted.end(), [](Judgement const& j) { return j.altered; }));
    double const genuine = static_cast<double>(sorted.size()) - altered;
    std::vector<RocPointOfScores> all;
    double fp = 0, tp = 0;
    for (std::size_t i = sorted.size(); i > 0;) {
        double const score = sorted[i - 1].score;
        for (; i > 0 && sorted[i - 1].score == score; --i) {
            (sorted[i - 1].altered ? tp : fp) += 1;
        }
        all.push_back({score, genuine > 0 ? fp / genuine : 0, altered > 0 ? tp / altered : 0});
    }
    std::vector<RocPointOfScores> out;
    std::size_t const step = all.size() / kPoints + 1;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i % step == 0 || i + 1 == all.size()) {
            out.push_back(all[i]);
        }
    }
    return out;
}

} // namespace

VerdictQuality verdict_quality(std::vector<Judgement> judgements, bool has_scores, std::uint64_t seed, int resamples,
                               std::size_t most_shares) {
    std::uint32_t blocks = 0;
    for (Judgement const& j : judgements) {
        blocks = std::max(blocks, j.block + 1);
    }
    std::vector<Counts> by_block(blocks);
    Counts all;
    for (Judgement const& j : judgements) {
        Counts& c = by_block[j.block];
        (j.altered ? (j.flagged ? c.tp : c.fn) : (j.flagged ? c.fp : c.tn)) += 1;
    }
    for (Counts const& c : by_block) {
        all.add(c, 1);
    }
    if (has_scores) {
        std::stable_sort(judgements.begin(), judgements.end(),
                         [](Judgement const& a, Judgement const& b) { return a.score < b.score; });
    }
    Figures value = figures_of(all);
    std::vector<ScoreShare> shares;
    double correction = 0;
    if (has_scores) {
        std::vector<double> const once(blocks, 1);
        shares = shares_of(judgements, blocks, 0);
        value[kAuc] = auc(shares, once);
        if (shares.size() > most_shares && value[kAuc]) {
            shares = shares_of(judgements, blocks, 2.0 * blocks / static_cast<double>(most_shares));
            correction = *value[kAuc] - auc(shares, once).value_or(*value[kAuc]);
        }
    }
    std::array<std::vector<double>, 5> drawn;
    Random random{seed, "bootstrap"};
    std::vector<double> times(blocks);
    for (int k = 0; k < resamples && blocks > 0; ++k) {
        std::fill(times.begin(), times.end(), 0);
        Counts sum;
        for (std::uint32_t b = 0; b < blocks; ++b) {
            auto const one = random.below(blocks);
            times[one] += 1;
            sum.add(by_block[one], 1);
        }
        Figures figures = figures_of(sum);
        if (has_scores) {
            figures[kAuc] = auc(shares, times);
            if (figures[kAuc]) {
                *figures[kAuc] = std::clamp(*figures[kAuc] + correction, 0.0, 1.0);
            }
        }
        for (std::size_t f = 0; f < figures.size(); ++f) {
            if (figures[f]) {
                drawn[f].push_back(*figures[f]);
            }
        }
    }
    auto const estimate = [&](Figure f) {
        std::vector<double>& d = drawn[f];
        std::sort(d.begin(), d.end());
        return value[f] && !d.empty() ? Estimate{value[f], nearest_rank(d, 0.025), nearest_rank(d, 0.975)}
                                      : Estimate{value[f], {}, {}};
    };
    VerdictQuality out;
    out.true_positives = static_cast<std::uint64_t>(all.tp);
    out.false_positives = static_cast<std::uint64_t>(all.fp);
    out.true_negatives = static_cast<std::uint64_t>(all.tn);
    out.false_negatives = static_cast<std::uint64_t>(all.fn);
    out.precision = estimate(kPrecision);
    out.recall = estimate(kRecall);
    out.f1 = estimate(kF1);
    out.false_positive_rate = estimate(kFalsePositiveRate);
    out.auc = estimate(kAuc);
    out.roc = has_scores ? roc(judgements) : std::vector<RocPointOfScores>{};
    return out;
}

} // namespace gridspace::ids
