// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// A place in the cable between a host and a switch: two interfaces of the process's own host, and the direction that
/// goes through its hands. Written by `gridspace run` for a process whose configuration names such a place.
struct BumpConfig {
    std::string host, link; ///< the ends of the cable
    std::string host_interface, switch_interface;
    /// The names that the lockstep ledgers know the pieces of the cable by, and what travels there.
    struct Way {
        std::string in, out; ///< `out` empty: its frames pass untouched, and are only heard
        std::vector<std::uint16_t> ethertypes;
    };
    std::optional<Way> from_host, to_host; ///< a direction that is not given passes untouched
};

/// The list `bumps:`.
void describe_bumps(config::Fields& f, std::vector<BumpConfig>& bumps);

} // namespace gridspace::gateways
