// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/overlay.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

struct Scenario;

/// One run of a study: a row of its table.
struct StudyRun {
    Point point;
    std::int64_t repetition{1}, seed{0};
    config::Node overlay; ///< of the scenario
    std::string key;      ///< of what it depends on; two runs with the same key are the same run
};

struct StudyPlan {
    std::string scenario; ///< its name
    std::vector<StudyRun> runs;
    std::vector<std::string> results; ///< names of the result columns
    std::size_t left_out{0};          ///< points that `where` left out
    bool lockstep{true};              ///< runs repeat octet for octet
};

/// "requested_h = 3, soc = 0.5, repetition 2": for messages.
[[nodiscard]] std::string describe(Study const& study, StudyRun const& run);

/// What more has to be true of each run's scenario; adds what is not to the diagnostics.
using RunCheck = std::function<void(Scenario const&, config::Diagnostics&)>;

/// All runs of a study, each of which was loaded as `gridspace run` loads it and checked: nothing is found wrong only
/// after hours. What is wrong is in `diagnostics`; nothing is returned then.
[[nodiscard]] std::optional<StudyPlan> plan_study(Study const& study, config::Diagnostics& diagnostics,
                                                  RunCheck const& check = {});

} // namespace gridspace::launcher
