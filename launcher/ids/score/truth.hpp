// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/streams/stream.hpp"
#include "launcher/ids/score/verdicts_file.hpp"
#include "launcher/judge/alarm_score.hpp"

#include <filesystem>

namespace gridspace::score {

/// What really happened in a run.
struct Truth {
    Extent extent;
    std::vector<launcher::IntrusionRecording::Label> labels;  ///< on streams of sampled values
    std::vector<launcher::AttackSpan> attacks;                ///< also on GOOSE and on topics
    std::map<std::string, std::uint64_t> messages_not_judged; ///< labels of GOOSE and of topics, by attack
};

/// The samples that a scenario's streams have until `simulated_s`; `only_stream` is left empty.
[[nodiscard]] Extent extent_of(std::vector<streams::Stream> const& streams, double simulated_s);

/// Of a run folder that came so far. Fails when nobody has labelled anything.
[[nodiscard]] Result<Truth> read_truth(std::filesystem::path const& run, double simulated_s);

} // namespace gridspace::score
