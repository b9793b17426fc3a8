// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/frame.hpp"

#include <array>
#include <optional>
#include <vector>

struct sock_filter; // NOLINT(readability-identifier-naming): the kernel calls it so

namespace gridspace::ethernet {

using iec61850::Mac;
using iec61850::Octets;

/// Which frames a port receives; an empty list takes any. The kernel drops the others before they cost us anything.
struct FrameFilter {
    std::vector<std::uint16_t> ethertypes;
    std::vector<std::uint16_t> app_ids; ///< of GOOSE and SV
    std::vector<Mac> destinations;
    struct Sources {
        std::array<std::uint8_t, 3> prefix; ///< the first octets of the source address
        bool others{false};                 ///< all but these
    };
    std::optional<Sources> sources;
    bool routable{false}; ///< also GOOSE and SV over UDP, whatever the lists say

    [[nodiscard]] bool empty() const noexcept {
        return ethertypes.empty() && app_ids.empty() && destinations.empty() && !sources;
    }
    /// The same decision in user space, for kernels that take no filter; a VLAN tag may be there or not.
    [[nodiscard]] bool matches(Octets frame) const noexcept;
    /// The same decision as a classic BPF program. Lists too long for its short jumps are left out of it: matches()
    /// then decides about them.
    [[nodiscard]] std::vector<sock_filter> program() const;
    [[nodiscard]] bool kernel_decides() const noexcept;
};

} // namespace gridspace::ethernet
