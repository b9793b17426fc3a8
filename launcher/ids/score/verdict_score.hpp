// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/scoring/scorer.hpp"
#include "ids/scoring/verdict_quality.hpp"
#include "launcher/ids/score/truth.hpp"

namespace gridspace::score {

struct VerdictScore {
    ids::VerdictQuality quality;
    std::uint64_t judged{0};           ///< samples, or phase-samples, that have a verdict
    std::uint64_t altered{0};          ///< of the run
    std::uint64_t altered_unjudged{0}; ///< have no verdict: they count as missed
    bool by_phase{false}, has_scores{false};
    struct Attack {
        std::string kind, target;
        std::optional<double> delay_ms; ///< from its first altered sample to the first that was flagged
        ids::AttackScore score;
    };
    std::vector<Attack> attacks;
    struct Kind { ///< all attacks of a kind together
        std::string kind;
        std::uint64_t attacks{0}, seen{0}; ///< seen: at least one altered sample was flagged
        ids::Share recall;                 ///< of the altered samples
    };
    std::vector<Kind> kinds; ///< by name
    std::map<std::string, std::uint64_t> messages_not_judged;
    launcher::AlarmScore alarms; ///< of the attacks on samples, see alarms_of
};

/// An alarm begins with a flagged sample of any stream, and stands until none was flagged for kAlarmWithinS.
[[nodiscard]] std::vector<launcher::RaisedAlarm> alarms_of(Verdicts const& verdicts, Extent const& extent);

/// `others_are_genuine`: samples of the run without a row count as verdict 0 (a list of alarms).
[[nodiscard]] VerdictScore score_verdicts(Truth const& truth, Verdicts verdicts, bool others_are_genuine,
                                          std::uint64_t seed);

} // namespace gridspace::score
