// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/alarm_score.hpp"
#include "launcher/judge/intrusion_score.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What attacks and disturbances did to the grid, apart from what detectors found.
struct Consequences {
    std::uint64_t faults{0}, lost{0}, false_trips{0}; ///< lost: the relay does not trip, or no breaker behind it opens
    std::optional<double> slowest_trip_ms;            ///< from a fault to its trip, of those that were tripped on
    std::vector<std::string> opened_without_fault;    ///< breakers, each as often as it happened
    std::uint64_t compared{0},
        late{0}; ///< faults on which the same relay without a detector tripped too; later than it

    struct Load {
        std::string load;
        double asked_kw{0};           ///< at the end of the run, at 1 p.u.
        double most_not_served_kw{0}; ///< largest
        double not_served_wh{0};
    };
    std::vector<Load> loads;          ///< whose power was recorded and whose demand is known
    std::vector<std::string> unknown; ///< loads that are not judged
    double load_not_served_kw{0};     ///< largest of their sum
    double energy_not_served_wh{0};

    AlarmScore alarms; ///< of whoever raised them
};

/// Whether somebody or something works against the run: attacks, impaired cables, processes that are killed or stopped.
[[nodiscard]] bool is_disturbed(config::Node const& scenario);

/// While a load gets less than half of what it asks for (its power at 1 p.u., with what events have set), all that it
/// does not get is not served. A load in the dark is; one at 0.9 p.u. is not.
[[nodiscard]] Consequences find_consequences(IntrusionScore const& score, config::Node const& scenario,
                                             config::Node const& network, SignalStore const& signals, double end_s);

/// One of its figures; without a value when nothing is known of it.
struct ConsequenceSignal {
    std::string name, unit;
    std::optional<double> value;
};
[[nodiscard]] std::vector<ConsequenceSignal> consequence_signals(Consequences const& consequences);
/// Adds them as signals with one value, and of each attack score.ATTACK.alarmed and alarm_ms.
void add_consequence_signals(Consequences const& consequences, double end_s, SignalStore& signals);

} // namespace gridspace::launcher
