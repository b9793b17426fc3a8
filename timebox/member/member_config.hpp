// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "gateways/port/wire_config.hpp"
#include "timebox/ip/ip_link.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::timebox {

/// A topic of DDS that a program reads or writes.
struct BoxedTopic {
    std::string topic, type;
    std::filesystem::path idl; ///< that defines the type; empty: it is one of ours
};

/// A program in simulated time as a member of a run. Written by `gridspace run`.
struct MemberConfig {
    std::vector<std::string> command;
    std::int64_t seed{1}; ///< of the scenario
    Rational latency_us{0};
    gateways::WireConfig wire;
    std::vector<std::uint16_t> sends, receives; ///< ethertypes
    std::optional<IpLink> ip;
    std::vector<BoxedTopic> reads, writes;
    std::int64_t dds_domain{0}; ///< in which the program is
};
void describe(config::Fields& f, MemberConfig& c);

} // namespace gridspace::timebox
