// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/event_report.hpp"
#include "agents/relay/foreign_detector.hpp"
#include "agents/relay/functions/bay_relay.hpp"
#include "agents/relay/guarded_relay.hpp"
#include "agents/relay/intrusion_output.hpp"
#include "agents/relay/relay_signals.hpp"
#include "bus/daemon.hpp"
#include "gateways/port/first_line_report.hpp"
#include "gateways/port/wire_config.hpp"

#include <memory>
#include <optional>

namespace gridspace::relay {

struct RelaySettings {
    RelayConfig relay;
    gateways::WireConfig wire;
};

/// Which end of the inputs an input of a bay comes from.
struct BaySource {
    std::size_t end{0};
};
struct BaySources {
    std::optional<BaySource> currents, voltages, bus_voltages;
};

/// What gridspace-relay is made of.
struct RelayParts {
    double rate_hz{0};                   ///< of the streams
    std::unique_ptr<GuardedRelay> relay; ///< of a line
    std::unique_ptr<BayRelay> bay;       ///< or of a bay
    BaySources sources;
    std::unique_ptr<IntrusionOutput> intrusion; ///< with a detector
    std::unique_ptr<ForeignDetector> foreign;   ///< with somebody else's
    std::unique_ptr<CurrentInputs> inputs;
    std::unique_ptr<EventReport> event_report; ///< when it is wanted
    std::unique_ptr<gateways::WirePort> port;
    std::unique_ptr<TripPublisher> trip;
    std::unique_ptr<RelaySignals> signals;
    std::unique_ptr<gateways::FirstLineReport> first_line; ///< unless the rules are off
};

/// Makes them of the settings, and opens what they need. Before Node::start.
[[nodiscard]] Result<RelayParts> make_parts(RelaySettings const& settings, DaemonRun& run, bus::Node& node);

} // namespace gridspace::relay
