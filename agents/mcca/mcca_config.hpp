// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/mcca/mcca_logic.hpp"
#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"

namespace gridspace::agents {

/// Settings of gridspace-mcca.
struct MccaConfig {
    std::vector<config::Ref> evs;
    Rational request_timeout_s{30};
    Rational latency_us{0}; ///< from the last request to the effect of the decision
    MccaRules rules;
};

void describe(config::Fields& f, MccaConfig& config);

/// gridspace-mcca, for everybody who has to know about it.
[[nodiscard]] program::Declaration mcca_declaration();

} // namespace gridspace::agents
