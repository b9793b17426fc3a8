// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <memory>

namespace gridspace::sim::phasor {

struct PhasorOptions {
    TimeBase time_base;
    double start_hour_of_day{0}; ///< of simulated time 0
    double relative_tolerance{1e-8};
    double absolute_tolerance{1e-9};
    /// Length of fixed steps, s; 0: IDA chooses its own.
    double fixed_step_s{0};
};

/// Balanced phasor simulation: the network's algebraic equations together with the injections' states, as one DAE
/// (docs/design/phasor.md). Fails when the network holds what it has no model for yet.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_phasor_engine(Network network, PhasorOptions options);

/// What of this network phasors do not show, in words: harmonics, saturation, travelling waves, unbalance.
[[nodiscard]] std::vector<std::string> unseen_by_phasors(Network const& network);

/// The signals that such an engine has, without solving anything.
[[nodiscard]] std::vector<SignalDef> phasor_signals(Network const& network);

} // namespace gridspace::sim::phasor
