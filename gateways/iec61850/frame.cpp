// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/frame.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::uint16_t kServiceVlanEthertype = 0x88A8; // 802.1ad, the outer tag of two

bool is_vlan(std::uint16_t ethertype) noexcept {
    return ethertype == kVlanEthertype || ethertype == kServiceVlanEthertype;
}

int hex_digit(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

} // namespace

std::string Mac::to_string() const {
    return fmt::format("{:02X}:{:02X}:{:02X}:{:02X}:{:02X}:{:02X}", octets[0], octets[1], octets[2], octets[3],
                       octets[4], octets[5]);
}

std::optional<Mac> Mac::parse(std::string_view text) {
    if (text.size() != 17) {
        return std::nullopt;
    }
    Mac mac;
    for (std::size_t i = 0; i < 6; ++i) {
        int const high = hex_digit(text[3 * i]), low = hex_digit(text[3 * i + 1]);
        bool const separated =
            i == 5 || ((text[3 * i + 2] == ':' || text[3 * i + 2] == '-') && text[3 * i + 2] == text[2]);
        if (high < 0 || low < 0 || !separated) {
            return std::nullopt;
        }
        mac.octets[i] = static_cast<std::uint8_t>(high * 16 + low);
    }
    return mac;
}

std::size_t ethernet_header_octets(Octets frame) noexcept {
    std::size_t at = 14;
    for (int tags = 0; tags < 2 && frame.size() >= at && is_vlan(load_be<std::uint16_t>(frame.data() + at - 2));
         ++tags) {
        at += 4;
    }
    return at;
}

std::uint16_t ethertype_of(Octets frame) noexcept {
    std::size_t const header = ethernet_header_octets(frame);
    auto const ethertype = frame.size() < header ? std::uint16_t{0} : load_be<std::uint16_t>(frame.data() + header - 2);
    return is_vlan(ethertype) ? std::uint16_t{0} : ethertype; // of a third tag
}

Decoded<void> decode_header(Octets frame, FrameHeader& out) noexcept {
    if (frame.size() < 14 + kHeaderOctets) {
        return undecodable(Reason::too_short, frame.size());
    }
    std::uint8_t const* const data = frame.data();
    std::copy_n(data, 6, out.destination.octets.begin());
    std::copy_n(data + 6, 6, out.source.octets.begin());
    out.vlan.reset();
    std::size_t at = 12;
    out.ethertype = load_be<std::uint16_t>(data + at);
    for (int tags = 0; tags < 2 && is_vlan(out.ethertype); ++tags) {
        if (frame.size() < at + 6 + kHeaderOctets) {
            return undecodable(Reason::too_short, frame.size());
        }
        if (!out.vlan) {
            out.vlan = VlanTag::from_tci(load_be<std::uint16_t>(data + at + 2));
        }
        at += 4;
        out.ethertype = load_be<std::uint16_t>(data + at);
    }
    if (out.ethertype != kGooseEthertype && out.ethertype != kSvEthertype) {
        return undecodable(Reason::other_ethertype, at);
    }
    at += 2;
    if (frame.size() < at + kHeaderOctets) {
        return undecodable(Reason::too_short, frame.size());
    }
    out.app_id = load_be<std::uint16_t>(data + at);
    out.length = load_be<std::uint16_t>(data + at + 2);
    out.reserved1 = load_be<std::uint16_t>(data + at + 4);
    out.reserved2 = load_be<std::uint16_t>(data + at + 6);
    if (out.length < kHeaderOctets || out.length > frame.size() - at) {
        return undecodable(Reason::bad_frame_length, at + 2);
    }
    out.apdu_offset = static_cast<std::uint32_t>(at + kHeaderOctets);
    out.apdu = frame.subspan(out.apdu_offset, out.length - kHeaderOctets);
    return {};
}

void append_ethernet_header(std::vector<std::uint8_t>& out, Mac const& destination, Mac const& source,
                            std::optional<VlanTag> const& vlan, std::uint16_t ethertype) {
    append(out, destination.octets);
    append(out, source.octets);
    if (vlan) {
        append_be(out, kVlanEthertype);
        append_be(out, vlan->tci());
    }
    append_be(out, ethertype);
}

void append_header(std::vector<std::uint8_t>& out, Address const& address, std::uint16_t ethertype) {
    append_ethernet_header(out, address.destination, address.source, address.vlan, ethertype);
    append_be(out, address.app_id);
    append_be(out, std::uint16_t{0});
    append_be(out, address.simulated ? kSimulatedBit : std::uint16_t{0});
    append_be(out, std::uint16_t{0});
}

} // namespace gridspace::iec61850
