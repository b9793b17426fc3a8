// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/stream_timing.hpp"
#include "launcher/judge/trip_chain.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace gridspace::launcher {

constexpr double kTransferClassMs = 3; ///< IEC 61850-5, transfer time class TT6: trips (P1) and raw data (P7)

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

/// What the recorded signals say about the wires of a scenario, and the capture where no signal does.
[[nodiscard]] WireTiming measure_wire_timing(Results const& results, config::Node const& scenario);

} // namespace gridspace::launcher
