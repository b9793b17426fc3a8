// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/line_relay.hpp"
#include "ids/data/waveform.hpp"
#include "ids/detector/line_detector.hpp"
#include "ids/evaluation/attack_catalogue.hpp"

#include <cstdint>

namespace gridspace::ids {

/// What a relay with a detector in front of it did in one recording. Sample indices; -1: never.
struct TrialOutcome {
    std::int64_t trip{-1};
    std::int64_t pickup{-1};
    std::uint64_t alarms{0};
    std::int64_t alarm{-1}; ///< the first one, of an attack at or after its start, but for that of noise
    bool locked_out{false}; ///< at the end
};

/// Lets a line relay and its detector live through a recording, coupled as in the relay program: the detector sees a
/// sample first, knows what the relay's element said about the sample before, and the relay gets what the detector
/// accepted. `attack` (may be null) forges the samples on their way.
[[nodiscard]] TrialOutcome run_trial(Model const& model, DetectorParams const& detector,
                                     relay::RelayParams const& relay, LineWaveform const& recording,
                                     CataloguedAttack const* attack, std::uint64_t seed);

} // namespace gridspace::ids
