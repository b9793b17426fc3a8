// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "sim/engine/action.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {

using config::Ref;
struct Network;

/// One entry of a scenario's `events:`, physical or cyber. All of them stand on one timeline; file order decides at
/// equal times.
struct Event {
    Ref name;
    std::optional<Rational> at_s;
    std::vector<std::pair<Ref, double>> set;             ///< parameter paths of the network and their new values
    std::vector<std::pair<Ref, double>> set_impairments; ///< the same of `impairments:`; true is 1
    std::vector<Ref> open, close;                        ///< breakers
    std::vector<Ref> start, stop;                        ///< converters
    std::vector<Ref> reset;                              ///< breakers whose mechanism works again
    std::vector<std::pair<Ref, std::string>> mode;       ///< elements, and how their regulators work from then on
    std::optional<ApplyFault> fault;
    Ref fault_line, fault_bus;
    std::optional<Rational> clear_after_ms;
    Ref disconnect, connect;
    std::vector<Ref> fail_to_open;    ///< breakers that no command opens from then on
    Ref desynchronise, resynchronise; ///< merging units whose clock is lost, and found again
    std::int64_t shift_samples{0};    ///< desynchronise: how far the clock runs ahead
    Ref kill, pause, resume, restart; ///< processes
};

/// A physical change at an instant.
struct TimedAction {
    Rational at_s;
    Action action;
    std::string event; ///< its name, for logs and reports
};

void describe(config::Fields& f, Event& event);

/// A breaker whose mechanism is stuck from an instant on.
struct StuckBreaker {
    Rational from_s;
    std::string breaker;
};
[[nodiscard]] std::vector<StuckBreaker> stuck_breakers(std::vector<Event> const& events);

/// What an entry of `events:` may do, for its reader and for docs/reference/actions.md.
struct EventAction {
    std::string_view key, doc;
    std::string_view of_agents{}; ///< how an agent does the same; empty: it cannot
};
[[nodiscard]] std::span<EventAction const> event_actions();

/// Reads the whole `events:` map of `parent`.
void describe_events(config::Fields& parent, std::vector<Event>& events);

/// The physical changes of all events, in the order in which they happen.
[[nodiscard]] std::vector<TimedAction> timeline(std::vector<Event> const& events);

/// Names that events use must exist in the network.
void check_events(std::vector<Event> const& events, Network const& network, bool waveform,
                  config::Diagnostics& diagnostics);

} // namespace gridspace::sim
