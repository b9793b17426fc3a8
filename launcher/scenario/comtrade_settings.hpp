// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

struct Scenario;

/// `record.comtrade`: waveform files around what happened.
struct ComtradeSettings {
    config::Ref trigger; ///< "relay2.trip", a signal that rises from zero, or an event of the timeline
    double before_ms{200}, after_ms{500};
    bool single_file{false}; ///< .cff in place of .cfg and .dat
    std::vector<config::Ref>
        signals; ///< patterns, in addition to the currents, voltages and digitals that belong to the trigger

    /// The signal behind the trigger; "relay2.trip" is short for "relay.relay2.trip".
    [[nodiscard]] std::vector<std::string> trigger_signals() const { return {trigger.name, "relay." + trigger.name}; }
};
void describe(config::Fields& f, ComtradeSettings& settings);

/// A pattern of `signals` that is one word means the signals whose last part it is: `raw` is `*.raw`.
[[nodiscard]] std::string comtrade_pattern(std::string const& written);

/// The channels of a record around something that a relay did: three currents of both ends (and every transformer when
/// it is not about a relay), the voltages of all buses, pickup and trip, the poles of its breakers. Names of signals.
struct ComtradeChannels {
    std::vector<std::string> analog, digital;
};
[[nodiscard]] ComtradeChannels usual_channels(config::Node const& scenario, std::string const& trigger_signal);

/// The trigger exists, and the simulator publishes what the files need.
void check_comtrade(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
