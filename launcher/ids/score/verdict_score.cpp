// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/score/verdict_score.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace gridspace::score {
namespace {

constexpr double kBlockS = 0.1;

std::map<SampleKey, std::string> altered_samples(Truth const& truth, bool by_phase) {
    std::map<SampleKey, std::string> out; ///< and by which attack
    for (auto const& label : truth.labels) {
        if (by_phase && label.channel > 2) {
            continue; // the frame was attacked and no current: verdicts by phase do not speak of it
        }
        out.emplace(SampleKey{label.target, label.index, by_phase ? label.channel : std::uint8_t{0}}, label.attack);
    }
    return out;
}

/// Every other sample of a stream that was judged is said to be genuine.
void add_unnamed(Truth const& truth, double score, Verdicts& verdicts) {
    std::set<std::string> judged;
    for (auto const& [key, verdict] : verdicts.all) {
        judged.insert(key.stream);
    }
    for (std::string const& stream : judged) {
        for (std::int64_t i = 0; i < truth.extent.samples(stream); ++i) {
            for (std::uint8_t phase = 0; phase < (verdicts.by_phase ? 3 : 1); ++phase) {
                verdicts.all.try_emplace({stream, i, phase}, Verdict{false, score});
            }
        }
    }
}

std::vector<VerdictScore::Kind> kinds_of(std::vector<VerdictScore::Attack> const& attacks) {
    std::vector<VerdictScore::Kind> out;
    std::map<std::string, VerdictScore::Kind> kinds;
    for (VerdictScore::Attack const& attack : attacks) {
        VerdictScore::Kind& kind =
            kinds.try_emplace(attack.kind, VerdictScore::Kind{attack.kind, 0, 0, {}}).first->second;
        ++kind.attacks;
        kind.seen += attack.score.seen ? 1U : 0U;
        kind.recall.count += attack.score.detected.count;
        kind.recall.of += attack.score.detected.of;
    }
    for (auto& [name, kind] : kinds) {
        kind.recall = ids::share_of(kind.recall.count, kind.recall.of);
        out.push_back(std::move(kind));
    }
    return out;
}

/// Of a detector that says something about samples, whose flags make the alarms.
std::vector<launcher::RaisedAlarm> flagged_alarms(Verdicts const& verdicts, Extent const& extent) {
    std::vector<double> flagged_s;
    for (auto const& [key, verdict] : verdicts.all) {
        if (verdict.flagged) {
            flagged_s.push_back(static_cast<double>(key.index) / extent.rates_hz.at(key.stream));
        }
    }
    std::sort(flagged_s.begin(), flagged_s.end());
    std::vector<launcher::RaisedAlarm> out;
    for (double const at_s : flagged_s) {
        if (out.empty() || at_s > out.back().to_s) {
            out.push_back({at_s, at_s, {}});
        }
        out.back().to_s = at_s + launcher::kAlarmWithinS;
    }
    return out;
}

} // namespace

std::vector<launcher::RaisedAlarm> alarms_of(Verdicts const& verdicts, Extent const& extent) {
    return verdicts.is_alarms ? launcher::raised_alarms(verdicts.alarm_from_s, {}, extent.end_s)
                              : flagged_alarms(verdicts, extent);
}

VerdictScore score_verdicts(Truth const& truth, Verdicts verdicts, bool others_are_genuine, std::uint64_t seed) {
    VerdictScore out;
    out.by_phase = verdicts.by_phase;
    out.has_scores = verdicts.has_scores;
    std::vector<launcher::AttackSpan> on_samples;
    std::copy_if(truth.attacks.begin(), truth.attacks.end(), std::back_inserter(on_samples),
                 [&](launcher::AttackSpan const& a) { return truth.extent.rates_hz.contains(a.target); });
    out.alarms = launcher::score_alarms(std::move(on_samples), alarms_of(verdicts, truth.extent), truth.extent.end_s);
    out.judged = verdicts.all.size();
    out.messages_not_judged = truth.messages_not_judged;
    auto const altered = altered_samples(truth, verdicts.by_phase);
    out.altered = altered.size();
    double lowest = 0;
    for (auto const& [key, verdict] : verdicts.all) {
        lowest = std::min(lowest, verdict.score);
    }
    for (auto const& [key, attack] : altered) {
        out.altered_unjudged += verdicts.all.try_emplace(key, Verdict{false, lowest}).second ? 1U : 0U;
    }
    if (others_are_genuine) {
        add_unnamed(truth, lowest, verdicts);
    }
    ids::Scorer scorer;
    std::map<std::pair<std::string, std::int64_t>, std::uint32_t> blocks;
    std::vector<ids::Judgement> judgements;
    for (auto const& [key, verdict] : verdicts.all) {
        auto const number =
            static_cast<std::int64_t>(static_cast<double>(key.index) / truth.extent.rates_hz.at(key.stream) / kBlockS);
        auto const block =
            blocks.try_emplace({key.stream, number}, static_cast<std::uint32_t>(blocks.size())).first->second;
        judgements.push_back({block, altered.contains(key), verdict.flagged, verdict.score});
        scorer.add(ids::ScoredVerdict{key.stream, key.index, key.phase, 0, 0, 0, 0, verdict.flagged, verdict.flagged});
    }
    std::map<std::string, launcher::IntrusionRecording::Label const*> first;
    for (auto const& label : truth.labels) {
        scorer.add(ids::ScoredLabel{label.attack, label.target, label.index,
                                    verdicts.by_phase ? label.channel : std::uint8_t{0}, label.true_value,
                                    label.sent_value});
        first.try_emplace(label.attack, &label);
    }
    out.quality = ids::verdict_quality(std::move(judgements), verdicts.has_scores, seed);
    for (ids::AttackScore& attack : scorer.score().attacks) {
        auto const& label = *first.at(attack.attack);
        std::optional<double> delay;
        if (attack.seen) {
            delay = 1e3 * static_cast<double>(attack.delay_samples) / truth.extent.rates_hz.at(label.target);
        }
        out.attacks.push_back({label.kind, label.target, delay, std::move(attack)});
    }
    out.kinds = kinds_of(out.attacks);
    return out;
}

} // namespace gridspace::score
