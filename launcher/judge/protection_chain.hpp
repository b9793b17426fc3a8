// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <array>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What belongs to a relay in a scenario: transformer -> topic -> merging unit -> stream -> relay -> GOOSE -> breaker
/// IED -> topic -> breakers. What is not ours (somebody's device) stays empty.
struct ProtectionChain {
    struct End {
        std::string stream, unit, topic, transformer;
    };
    struct BreakerIed {
        std::string process, topic;
        std::vector<std::string> breakers;
    };
    std::string relay, trip_stream;
    std::array<End, 2> ends; ///< from, to
    std::vector<BreakerIed> ieds;
    std::string gateway; ///< the simulator's, which usually bears the line's name

    [[nodiscard]] std::vector<std::string> breakers() const;
};

/// One for each gridspace-relay of a resolved scenario, in its order.
[[nodiscard]] std::vector<ProtectionChain> protection_chains(config::Node const& scenario);

/// One for each stream that trips our breaker IEDs and is sent by no gridspace-relay: `relay` is the stream's name.
[[nodiscard]] std::vector<ProtectionChain> foreign_chains(config::Node const& scenario);

} // namespace gridspace::launcher
