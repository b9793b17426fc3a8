// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/event_report_config.hpp"
#include "agents/relay/relay_config.hpp"
#include "gateways/first_line/first_line_config.hpp"
#include "ids/detector/detector_config.hpp"

#include <array>
#include <optional>
#include <string>

namespace gridspace::relay {

using config::Ref;

/// Counters of a guarded stream, by the last part of their signals' names; in the order of ids::GuardCounters.
inline constexpr std::array<char const*, 7> kIdsCounters{"samples", "flagged",  "open_flagged", "replaced",
                                                         "filled",  "restarts", "unusable"};

/// gridspace-relay: two streams of sampled currents in, a trip by GOOSE out.
struct RelayConfig {
    Ref from_stream, to_stream; ///< of the two ends of the line
    std::array<std::string, 3> channels{"Ia", "Ib", "Ic"};
    Ref trip; ///< GOOSE stream
    std::string trip_field{"status"};
    enum class TripOutput { enabled, blocked } trip_output{TripOutput::enabled};
    RelayLogicConfig logic;
    gateways::FirstLineConfig first_line; ///< of both streams of currents
    EventReportConfig event_report;
    std::optional<ids::DetectorConfig> ids; ///< the intrusion detector in front of it
    double partner_timeout_ms{20};          ///< how long the sample of one end waits for the other
    Rational latency_us{900};               ///< from a frame to the message; in real time a hold-back
    double frequency_hz{60};                ///< of the network; the launcher takes it from there
    Positive from_positive{Positive::from_to},
        to_positive{Positive::from_to}; ///< of the CTs; the launcher takes them from the network
};
void describe(config::Fields& f, RelayConfig& config);

} // namespace gridspace::relay
