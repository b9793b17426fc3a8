// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/protection_chain.hpp"
#include "launcher/judge/results.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

constexpr double kTransferClassMs = 3; ///< IEC 61850-5, transfer time class TT6: trips (P1) and raw data (P7)

/// Of a set of delays or intervals, milliseconds. Percentiles by nearest rank.
struct Spread {
    std::size_t count{0};
    double min{0}, mean{0}, p50{0}, p99{0}, p999{0}, max{0};
    std::size_t below_zero{0};
    /// Nothing arrives before it was sent: below zero, the clocks of the two ends are not one, and no figure means
    /// anything.
    [[nodiscard]] bool measurable() const { return below_zero == 0; }
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

struct SmvTiming {
    std::string stream;
    bool captured{false};         ///< counted in the capture, not by a relay of ours
    std::size_t other_senders{0}; ///< that use the same name and APPID: the counts are of the one with most frames
    std::optional<double> nominal_hz;
    std::size_t received{0}, lost{0}, duplicate{0}, late{0};
    std::size_t refused{0};  ///< simulated, damaged, or of another identity, revision or size; they are among the lost
    std::string not_counted; ///< "what relay1 counted from 0 s to 0.4 s": the counters are no less than that much
    std::size_t samples_per_frame{1};
    double mean_hz{0};                   ///< samples over arrivals, by least squares; 0 in lockstep
    std::vector<std::int64_t> sample_ns; ///< simulated instants of the last samples of the frames, in order
    std::vector<double> arrival_ms;      ///< of each frame on the wall clock, since the start; empty in lockstep
    Spread interval;                     ///< between the arrivals of two frames
    Spread publish_age, wire_delay;
};

struct GooseTiming {
    std::string stream;
    bool captured{false}; ///< intervals are those of the capture, not the sender's own
    std::size_t messages{0};
    std::optional<double> steady_ms;  ///< median interval where it no longer grows; nothing when it nowhere does
    std::optional<std::size_t> event; ///< index of the first message of the new state
    std::vector<double> interval_ms;  ///< of each message, to the one before
    Spread wire_delay;
};

struct ChainStep {
    std::string what, method;
    double after_ms{0};                    ///< since the fault
    bool communication{false};             ///< the transfer of a message, which is what the class is about
    std::optional<double> since_before_ms; ///< nothing: the two are of different clocks
    bool simulated{false};                 ///< an instant of simulated time
    bool opens{false};                     ///< breakers open side by side, each counted from the command
};

struct RelayTiming {
    std::string relay;
    bool foreign{false};  ///< not a program of ours: `relay` is the stream of its trip
    Spread transfer;      ///< sample instant to decision
    std::string event;    ///< what the chain begins with; empty: no trip
    bool own_line{false}; ///< the event is a fault on a line whose current the relay gets
    double event_s{0};
    std::vector<double> trips_s; ///< instants of the samples that made it trip; the chain is the first one's
    std::vector<ChainStep> chain;
};

struct WireTiming {
    bool lockstep{false};
    std::vector<SmvTiming> smv;
    std::vector<GooseTiming> goose;
    std::vector<RelayTiming> relays;
    std::vector<std::string> not_seen; ///< declared streams that neither a signal nor the capture tells of
    [[nodiscard]] bool empty() const { return smv.empty() && goose.empty() && relays_without_trip(); }

  private:
    [[nodiscard]] bool relays_without_trip() const {
        return std::all_of(relays.begin(), relays.end(), [](RelayTiming const& r) { return r.chain.empty(); });
    }
};

/// Declared streams for whose receiver no complete counters (sampled values) or whose sender no rows (GOOSE) were
/// recorded.
[[nodiscard]] std::vector<std::string> uncounted_streams(Results const& results, config::Node const& scenario);

/// What the recorded signals say about the wires of a scenario, and the capture where no signal does.
[[nodiscard]] WireTiming measure_wire_timing(Results const& results, config::Node const& scenario);

} // namespace gridspace::launcher
