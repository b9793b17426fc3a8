// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/actions/action_table.hpp"

#include <string>
#include <vector>

/// A network as an FMU (FMI 3.0, co-simulation): what goes in, what comes out, how it is stepped.
namespace gridspace::sim {

/// A variable of causality input of an exported network: what an agent may do with a sample (sim/actions).
struct GridInput {
    /// "set_point.battery.BAT1.p_kw"; of commands "command.breaker.B1.closed", "command.machine.G1.mode".
    std::string name;
    std::string unit, doc;
    /// Of a set-point: what it is before anybody sets it, and the values that it can have.
    double start{0};
    config::NumberSpec range;
    /// Of a command: what `true` and `false` mean at the start.
    bool is_command{false}, on_at_start{true};

    /// Of a mode: the words of what this element is able to, by their values from 1 on.
    std::vector<std::string> modes;

    /// What becomes of the grid when the input has a new value; of a command 0 is false.
    [[nodiscard]] Action action(double value) const;

    std::string element, path; ///< path: of a set-point, "batteries.BAT1.p_kw"
    Command on{}, off{};       ///< of a command
};

/// All that elements of this network take in that solver, in the order of the table of actions: per element its
/// quantities, its commands, its mode.
[[nodiscard]] std::vector<GridInput> grid_inputs(Network const& network, bool waveform);

} // namespace gridspace::sim
