// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/design.hpp"

#include <string>

namespace gridspace::launcher {

/// What a run lays over the scenario: the study's `set`, the values of the point, further results, and the seed of a
/// repetition. Values keep the place in the study where they were written. `seed` empty: the scenario's own.
/// `unwanted`: expectations of the scenario that go.
[[nodiscard]] config::Node overlay_of(Study const& study, Point const& point, std::string const& seed,
                                      std::vector<std::string> const& unwanted);

/// A scenario file that extends the study's scenario by an overlay, so that one command repeats the run.
[[nodiscard]] std::string overlay_file(Study const& study, config::Node const& overlay);

/// A value as it stands in one cell of a table: "3", "~", "{a: 1, b: [2, 3]}".
[[nodiscard]] std::string cell_text(config::Node const& value);

} // namespace gridspace::launcher
