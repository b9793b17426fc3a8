// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/event_report_config.hpp"
#include "agents/relay/functions/bay_relay.hpp"
#include "agents/relay/relay_config.hpp"
#include "gateways/first_line/first_line_config.hpp"
#include "ids/detector/detector_config.hpp"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::relay {

using config::Ref;

/// Counters of a guarded stream, by the last part of their signals' names; in the order of ids::GuardCounters.
inline constexpr std::array<char const*, 7> kIdsCounters{"samples", "flagged",  "open_flagged", "replaced",
                                                         "filled",  "restarts", "unusable"};

/// `functions:`: the relay of a bay instead of the differential of a line.
struct BayConfig {
    Ref currents, voltages, bus_voltages; ///< streams; at most two different ones
    std::array<std::string, 3> current_members{"Ia", "Ib", "Ic"}, voltage_members{"Va", "Vb", "Vc"};
    config::Node functions;                           ///< read by make_functions()
    std::vector<std::pair<std::string, Ref>> outputs; ///< members of the trip stream, and what they say: PTOC1.op
    double offset_cycles{2};
    double minimum_v{0};
    double hold_ms{1000};
    bool reversed{false}; ///< the CT counts out of what is protected; the launcher takes it from the network
};

/// `foreign_detector:`: a detector of somebody else's, as a process of its own, whose verdicts permit the trip.
struct ForeignDetectorConfig {
    std::string verdicts; ///< topic of IdsVerdict
    double wait_ms{2}, hold_ms{33}, delay_ms{20};
    enum class OnFlagged { delay, block } on_flagged{OnFlagged::delay};
    enum class Unheard { trip, block } unheard{Unheard::trip};
};

/// gridspace-relay: sampled values in, a trip by GOOSE out.
struct RelayConfig {
    BayConfig bay;
    [[nodiscard]] bool is_of_bay() const { return !bay.functions.is_null(); }
    /// The streams that it hears, each once: of the line's ends, or of the bay.
    [[nodiscard]] std::vector<Ref> inputs() const;
    Ref from_stream, to_stream; ///< of the two ends of the line
    std::array<std::string, 3> channels{"Ia", "Ib", "Ic"};
    Ref trip; ///< GOOSE stream
    std::string trip_field{"status"};
    enum class TripOutput { enabled, blocked } trip_output{TripOutput::enabled};
    RelayLogicConfig logic;
    gateways::FirstLineConfig first_line; ///< of both streams of currents
    EventReportConfig event_report;
    std::optional<ids::DetectorConfig> ids;                ///< the intrusion detector in front of it
    std::optional<ForeignDetectorConfig> foreign_detector; ///< or somebody else's
    double partner_timeout_ms{20};                         ///< how long the sample of one end waits for the other
    Rational latency_us{900};                              ///< from a frame to the message; in real time a hold-back
    double frequency_hz{60};                               ///< of the network; the launcher takes it from there
    Positive from_positive{Positive::from_to},
        to_positive{Positive::from_to}; ///< of the CTs; the launcher takes them from the network
};
void describe(config::Fields& f, RelayConfig& config);

/// The relay of a bay whose streams have `rate_hz`.
[[nodiscard]] Result<BayParams> make_bay_params(RelayConfig const& config, Rational rate_hz);

} // namespace gridspace::relay
