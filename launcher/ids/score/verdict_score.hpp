// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/scoring/scorer.hpp"
#include "ids/scoring/verdict_quality.hpp"
#include "launcher/ids/score/verdicts_file.hpp"
#include "launcher/judge/intrusion_recording.hpp"

#include <filesystem>

namespace gridspace::score {

/// What really happened in a run.
struct Truth {
    Extent extent;
    std::vector<launcher::IntrusionRecording::Label> labels;  ///< on streams of sampled values
    std::map<std::string, std::uint64_t> messages_not_judged; ///< labels of GOOSE and of topics, by attack
};
/// Of a run folder that came so far. Fails when nobody has labelled anything that can be judged.
[[nodiscard]] Result<Truth> read_truth(std::filesystem::path const& run, double simulated_s);

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
    std::map<std::string, std::uint64_t> messages_not_judged;
};
/// `others_are_genuine`: samples of the run without a row count as verdict 0 (a list of alarms).
[[nodiscard]] VerdictScore score_verdicts(Truth const& truth, Verdicts verdicts, bool others_are_genuine,
                                          std::uint64_t seed);

} // namespace gridspace::score
