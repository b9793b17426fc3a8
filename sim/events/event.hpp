// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "sim/engine/action.hpp"
#include "sim/network/network.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::sim {

/// One entry of a scenario's `events:`, physical or cyber. All of them stand on one timeline; file order decides at equal
/// times.
struct Event {
    Ref name;
    std::optional<Rational> at_s;
    std::vector<std::pair<Ref, double>> set; ///< parameter paths and their new values
    std::vector<Ref> open, close;            ///< breakers
    std::optional<ApplyFault> fault;
    Ref fault_line, fault_bus;
    std::optional<Rational> clear_after_ms;
    Ref disconnect;
    Ref kill, pause, resume, restart; ///< processes
};

/// A physical change at an instant.
struct TimedAction {
    Rational at_s;
    Action action;
    std::string event; ///< its name, for logs and reports
};

void describe(config::Fields& f, Event& event);

/// Reads the whole `events:` map of `parent`.
void describe_events(config::Fields& parent, std::vector<Event>& events);

/// The physical changes of all events, in the order in which they happen.
[[nodiscard]] std::vector<TimedAction> timeline(std::vector<Event> const& events);

/// Names that events use must exist in the network.
void check_events(std::vector<Event> const& events, Network const& network, bool waveform,
                  config::Diagnostics& diagnostics);

} // namespace gridspace::sim
