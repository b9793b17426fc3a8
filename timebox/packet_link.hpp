// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_link.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace gridspace::timebox {

/// The network interface whose frames come and go in simulated time.
struct PacketLink {
    int index{0}; ///< the kernel's
    std::string name;
    std::array<std::uint8_t, 6> mac{};
    std::optional<IpLink> ip; ///< its IP sockets are served too; without it they are the kernel's
    /// A frame leaves the program at that simulated time. What is refused, or nothing.
    std::function<std::string(std::span<std::uint8_t const> frame, std::int64_t now_ns)> send;
};

} // namespace gridspace::timebox
