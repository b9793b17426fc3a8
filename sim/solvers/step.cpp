// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/solvers/step.hpp"

#include "sim/emt/step_choice.hpp"

namespace gridspace::sim {

void settle_step(EngineSettings& settings, Network const& network, Rational period) {
    if (!settings.step_auto) {
        return;
    }
    auto const needs = emt::step_needs(network, start_hour_of_day(settings));
    settings.step_s = needs ? emt::resolving_step(*needs, period) : period;
}

std::optional<StepWarning> step_warning(EngineSettings const& settings, Network const& network, Rational period) {
    if (!settings.waveform()) {
        return std::nullopt;
    }
    auto const needs = emt::step_needs(network, start_hour_of_day(settings));
    auto const advice = needs ? emt::step_advice(*needs, settings.step_s.to_double(), period) : std::nullopt;
    return advice ? std::optional{StepWarning{advice->message, advice->remedy}} : std::nullopt;
}

} // namespace gridspace::sim
