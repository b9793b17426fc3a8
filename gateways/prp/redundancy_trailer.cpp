// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/prp/redundancy_trailer.hpp"

#include "gateways/iec61850/frame.hpp"

#include <algorithm>

namespace gridspace::prp {
namespace {

constexpr std::size_t kAddresses = 12, kTag = 4, kEthernetHeader = kAddresses + 2;
constexpr std::size_t kSmallest = 60; ///< of a frame without FCS, IEEE 802.3

/// Octets before the payload: addresses, one VLAN tag if there is one, ethertype.
std::size_t header_of(Octets frame) noexcept {
    bool const tagged = frame.size() >= kEthernetHeader &&
                        iec61850::load_be<std::uint16_t>(&frame[kAddresses]) == iec61850::kVlanEthertype;
    return kEthernetHeader + (tagged ? kTag : 0);
}

} // namespace

void write_with_trailer(Octets frame, RedundancyTrailer const& trailer, std::vector<std::uint8_t>& out) {
    std::size_t const header = header_of(frame);
    out.assign(frame.begin(), frame.end());
    out.resize(std::max(out.size(), kSmallest + (header - kEthernetHeader)));
    std::size_t const size = out.size() - header + kTrailerOctets, at = out.size();
    out.resize(at + kTrailerOctets);
    iec61850::store_be(&out[at], trailer.sequence);
    iec61850::store_be(&out[at + 2], static_cast<std::uint16_t>(
                                         unsigned{static_cast<std::uint8_t>(trailer.lan)} << 12U | (size & 0xFFFU)));
    iec61850::store_be(&out[at + 4], kSuffix);
}

std::optional<RedundancyTrailer> trailer_of(Octets frame) noexcept {
    std::size_t const header = header_of(frame);
    if (frame.size() < header + kTrailerOctets) {
        return {};
    }
    std::uint8_t const* const at = frame.data() + frame.size() - kTrailerOctets;
    auto const lan_and_size = iec61850::load_be<std::uint16_t>(at + 2);
    auto const lan = static_cast<Lan>(lan_and_size >> 12U);
    if (iec61850::load_be<std::uint16_t>(at + 4) != kSuffix || (lan != Lan::a && lan != Lan::b) ||
        (lan_and_size & 0xFFFU) != ((frame.size() - header) & 0xFFFU)) {
        return {};
    }
    return RedundancyTrailer{iec61850::load_be<std::uint16_t>(at), lan};
}

} // namespace gridspace::prp
