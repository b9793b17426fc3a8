// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/team.hpp"
#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <memory>

namespace gridspace::sim::emt {

struct EmtOptions {
    TimeBase time_base;
    SimSpan step{1}; ///< usual step of the solver
    double start_hour_of_day{0};
    std::shared_ptr<Team> team{}; ///< does parts of a large network at once, with the same results
};

/// Waveform simulation of a network. Fails when the network holds what it has no model for, or cannot be solved.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_emt_engine(Network network, EmtOptions options);

} // namespace gridspace::sim::emt
