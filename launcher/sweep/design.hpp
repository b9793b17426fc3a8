// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/sweep/study.hpp"

#include <cstddef>
#include <vector>

namespace gridspace::launcher {

/// One combination of values, in the order of the study's parameters.
using Point = std::vector<config::Node>;

struct Design {
    std::vector<Point> points;
    std::size_t left_out{0}; ///< points that did not meet the conditions of `where`
};

/// The points of a study, in a fixed order: the last parameter varies fastest. Draws depend on the seed and on the
/// parameter's name alone, so a further parameter changes no other. Mistakes are in `diagnostics`: lists of different
/// lengths that are zipped, draws without a number of samples, conditions that cannot be read, more than kMaxStudyRuns.
[[nodiscard]] Design make_design(Study const& study, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
