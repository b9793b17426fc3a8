// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"
#include "sim/solvers/engine_settings.hpp"

#include <optional>
#include <string>

namespace gridspace::sim {

/// Of which steps are whole parts where nothing is sampled.
inline const Rational kUsualSamplePeriod{1, 4800};

/// Gives `step_s: auto` its value, a whole part of `period`. Nothing happens to a step that is a number, and to a
/// network that has no waveforms: making its engine says why.
void settle_step(EngineSettings& settings, Network const& network, Rational period);

/// Why waveforms in these steps would show an oscillation of the network wrongly; nothing when they do not. What is
/// advised is a whole part of `period`.
struct StepWarning {
    std::string message, hint;
};
[[nodiscard]] std::optional<StepWarning> step_warning(EngineSettings const& settings, Network const& network,
                                                      Rational period);

} // namespace gridspace::sim
