// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"
#include "launcher/sweep/study.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string_view>

namespace gridspace::launcher {

/// Columns that every table has; a parameter or result of such a name would be one of two.
inline constexpr std::array<std::string_view, 11> kTableColumns{
    "run", "key", "repetition", "seed", "state", "exit", "cause", "wall_s", "simulated_s", "folder", "command"};

/// The scenario of a study, before the study changes anything.
struct BaseScenario {
    std::unique_ptr<Scenario> scenario;
    config::Node written;                ///< as its files have it
    std::optional<config::Node> network; ///< its network file, where that is YAML
};
[[nodiscard]] std::optional<BaseScenario> load_base(Study const& study, config::Diagnostics& diagnostics);

/// What the study says must fit its scenario: paths are there, names are there, and no name is there twice.
void check_study(Study const& study, BaseScenario const& base, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
