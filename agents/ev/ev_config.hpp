// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/ev/ev_logic.hpp"
#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"

#include <vector>

namespace gridspace::agents {

/// Settings of gridspace-ev: one EV (`ev:`), or many light agents in one process (`evs:`).
struct EvConfig {
    struct Agent {
        config::Ref ev;
        std::string bus; ///< where its EV is plugged in; filled in by `gridspace run` from the network
        EvParams params;
    };
    std::vector<Agent> agents;
    Rational period_s{360};
    Rational latency_us{0}; ///< from measurement to request
};

void describe(config::Fields& f, EvConfig& config);

/// gridspace-ev, for everybody who has to know about it.
[[nodiscard]] program::Declaration ev_declaration();

} // namespace gridspace::agents
