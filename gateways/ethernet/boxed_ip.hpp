// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/routable.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

/// IPv4 of programs in simulated time and that of the kernels, on one link. The programs' has addresses of its own:
/// those of the run's hosts with one more bit. So no kernel takes it for its own, and answers; and what kernels send
/// (DDS) is not waited for in simulated time.
namespace gridspace::ethernet {

inline constexpr std::uint16_t kIpEthertype = 0x0800;
inline constexpr std::size_t kMarkedOctet = 3;
inline constexpr std::uint8_t kMark = 0x80;

[[nodiscard]] inline iec61850::Mac boxed_address(iec61850::Mac host) {
    host.octets[kMarkedOctet] |= kMark;
    return host;
}

[[nodiscard]] inline bool is_ip(iec61850::Octets frame) {
    return frame.size() > 14 && frame[12] == (kIpEthertype >> 8U) && frame[13] == (kIpEthertype & 0xFFU);
}
/// Of a program in simulated time, by its source address.
[[nodiscard]] inline bool is_boxed_ip(iec61850::Octets frame) {
    constexpr std::array<std::uint8_t, 3> kRun{0x02, 0x47, 0x53}; // as `gridspace run` gives them
    constexpr std::size_t kSource = 6;
    return is_ip(frame) && std::equal(kRun.begin(), kRun.end(), frame.begin() + kSource) &&
           (frame[kSource + kMarkedOctet] & kMark) != 0;
}

/// The channel of the simulation clock that a frame belongs to: the ethertype of its messages, over UDP too, or IP for
/// a program in simulated time; 0: IP of the kernels, which has none.
[[nodiscard]] inline std::uint16_t channel_of(iec61850::Octets frame) {
    if (is_boxed_ip(frame)) {
        return kIpEthertype;
    }
    std::uint16_t const ethertype = iec61850::stream_ethertype(frame);
    return ethertype == kIpEthertype ? std::uint16_t{0} : ethertype;
}

} // namespace gridspace::ethernet
