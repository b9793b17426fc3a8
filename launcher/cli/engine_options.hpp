// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/cli/verbs.hpp"
#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"
#include "sim/solvers/engine_settings.hpp"

#include <string>
#include <vector>

/// What verbs about a network alone have in common: how it is simulated, and what of it is looked at.
namespace gridspace::cli {

struct EngineOptions {
    std::string solver{"emt"}, until{"1"}, step;
    bool fixed_step{false};
};
void engine_options(Command verb, EngineOptions& options);

struct ChosenEngine {
    sim::EngineSettings settings;
    Rational until_s;
};
[[nodiscard]] Result<ChosenEngine> chosen_engine(EngineOptions const& options);

/// Gives `--step auto` its value; says it, and what steps of any other length show wrongly, unless it is to be quiet.
void settle_step(sim::EngineSettings& settings, sim::Network const& network, bool quiet);

/// Those names that match one of the patterns, in the order of the patterns; a pattern that was asked for and matches
/// nothing is a mistake. `what`: "signal"; `shown_by`: "--list-signals shows what there is".
[[nodiscard]] Result<std::vector<std::size_t>> choose(std::vector<std::string> const& names,
                                                      std::vector<std::string> const& asked,
                                                      std::vector<std::string> const& usual, std::string_view what,
                                                      std::string_view shown_by);
[[nodiscard]] std::vector<std::string> names_of(std::vector<sim::SignalDef> const& signals);

} // namespace gridspace::cli
