// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <optional>
#include <string>

namespace gridspace::launcher {

/// `published:` of a scenario: what a publication says about the same study, printed with what was measured. What is
/// drawn of it are lines of the figures in `report:`.
struct Published {
    std::string source;                  ///< where it stands
    std::string smv_figure, delay_table; ///< "Fig. 10": added to the captions
    std::optional<double> smv_rate_hz;
    std::optional<double> smv_delay_ms, goose_delay_ms; ///< means
    std::optional<double> delay_limit_ms;               ///< that it holds its delays against
};
void describe(config::Fields& f, Published& published);

/// Of a resolved scenario; empty where it has none.
[[nodiscard]] Published published_of(config::Node const& scenario);

} // namespace gridspace::launcher
