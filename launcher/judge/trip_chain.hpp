// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/protection_chain.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/judge/spread.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

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

/// From the sample that picked up to open poles, for the first trip of a relay of ours.
[[nodiscard]] RelayTiming relay_timing(Results const& results, config::Node const& scenario,
                                       ProtectionChain const& chain);
/// The chain behind a relay that is not ours: what its message did. Its inside is not measurable.
[[nodiscard]] RelayTiming foreign_timing(Results const& results, config::Node const& scenario,
                                         ProtectionChain const& chain);

} // namespace gridspace::launcher
