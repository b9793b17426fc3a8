// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/actions/action_table.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::sim {

/// An entry of `simulation.controls`: who may set a quantity of elements, or command them. Numbers are in the unit of
/// the quantity.
struct ControlConfig {
    Ref path; ///< "battery.BAT1.p_kw", or "breaker.CB1" for commands
    ActionKind const* kind{nullptr};
    std::string element;   ///< its name; may be a pattern with `*` and `?`
    std::string quantity;  ///< empty: commands
    std::vector<Ref> from; ///< processes
    std::optional<double> low, high, ramp_per_s;
    std::optional<double> hold_s, then; ///< how long the last value holds when its source is lost, and what follows
    std::vector<Ref> commands;          ///< empty: all that the elements follow

    [[nodiscard]] bool is_pattern() const { return element.find_first_of("*?") != std::string::npos; }
};

/// Reads `simulation.controls` (may be null).
[[nodiscard]] std::vector<ControlConfig> read_controls(config::Node const& controls, config::Diagnostics& diagnostics);
/// Elements, quantities, ranges and commands must fit the network and the solver.
void check_controls(std::vector<ControlConfig> const& controls, Network const& network, bool waveform,
                    config::Diagnostics& diagnostics);

/// Elements that an entry is about. An exact name goes before a pattern, so a pattern leaves out what is named.
[[nodiscard]] std::vector<std::string> elements_of(ControlConfig const& control, std::vector<ControlConfig> const& all,
                                                   Network const& network, bool waveform);

} // namespace gridspace::sim
