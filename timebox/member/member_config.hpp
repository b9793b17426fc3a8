// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "gateways/port/wire_config.hpp"
#include "timebox/ip/ip_link.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::timebox {

/// A program in simulated time as a member of a run. Written by `gridspace run`.
struct MemberConfig {
    std::vector<std::string> command;
    std::int64_t seed{1}; ///< of the scenario
    Rational latency_us{0};
    gateways::WireConfig wire;
    std::vector<std::uint16_t> sends, receives; ///< ethertypes
    std::optional<IpLink> ip;
};
void describe(config::Fields& f, MemberConfig& c);

} // namespace gridspace::timebox
