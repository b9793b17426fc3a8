// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ptp/management_message.hpp"

#include <algorithm>

namespace gridspace::ptp {
namespace {

// Offsets of octets: the common header (13.3), the management message (15.4.1), its TLV (15.5.2).
constexpr std::size_t kHeader = 34, kMessage = 48, kTlvHead = 6, kData = kMessage + kTlvHead;
constexpr std::uint8_t kManagement = 0x0D, kVersion = 2, kControl = 4, kNoInterval = 0x7F;
constexpr std::uint8_t kGet = 0, kResponse = 2;
constexpr std::uint16_t kManagementTlv = 1;
constexpr std::size_t kTimeStatusOctets = 50, kParentOctets = 32;

std::uint64_t number(std::span<std::uint8_t const> octets, std::size_t at, std::size_t count) {
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < count; ++i) {
        out = out << 8U | octets[at + i];
    }
    return out;
}

ClockIdentity identity(std::span<std::uint8_t const> octets, std::size_t at) {
    ClockIdentity out{};
    std::copy_n(octets.begin() + static_cast<std::ptrdiff_t>(at), out.size(), out.begin());
    return out;
}

} // namespace

std::vector<std::uint8_t> management_get(ManagementId id, std::uint8_t domain, std::uint16_t sequence) {
    std::vector<std::uint8_t> out(kData, 0);
    auto const put = [&](std::size_t at, std::uint16_t value) {
        out[at] = static_cast<std::uint8_t>(value >> 8U);
        out[at + 1] = static_cast<std::uint8_t>(value & 0xFFU);
    };
    out[0] = kManagement;
    out[1] = kVersion;
    put(2, static_cast<std::uint16_t>(out.size()));
    out[4] = domain;
    put(30, sequence);
    out[32] = kControl;
    out[33] = kNoInterval;
    std::fill_n(out.begin() + kHeader, 10, std::uint8_t{0xFF}); // targetPortIdentity: all ports of all clocks
    out[46] = kGet;
    put(kMessage, kManagementTlv);
    put(kMessage + 2, 2); // octets behind: the identifier alone
    put(kMessage + 4, static_cast<std::uint16_t>(id));
    return out;
}

std::optional<ManagementResponse> decode_response(std::span<std::uint8_t const> message, std::uint8_t domain) {
    if (message.size() < kData || (message[0] & 0x0FU) != kManagement || (message[1] & 0x0FU) != kVersion ||
        message[4] != domain || (message[46] & 0x0FU) != kResponse || number(message, kMessage, 2) != kManagementTlv) {
        return std::nullopt;
    }
    std::size_t const length = number(message, kMessage + 2, 2); // the identifier and its data
    if (length < 2 || message.size() < kMessage + 4 + length) {
        return std::nullopt;
    }
    auto const data = message.subspan(kData, length - 2);
    ManagementResponse out;
    out.from = identity(message, 20);
    out.sequence = static_cast<std::uint16_t>(number(message, 30, 2));
    switch (static_cast<ManagementId>(number(message, kMessage + 4, 2))) {
    case ManagementId::time_status:
        if (data.size() < kTimeStatusOctets) {
            return std::nullopt;
        }
        out.time_status =
            TimeStatus{static_cast<std::int64_t>(number(data, 0, 8)), static_cast<std::int64_t>(number(data, 8, 8)),
                       number(data, 38, 4) != 0, identity(data, 42)};
        return out;
    case ManagementId::parent_data_set:
        if (data.size() < kParentOctets) {
            return std::nullopt;
        }
        out.parent = ParentDataSet{identity(data, 24), data[19]};
        return out;
    }
    return std::nullopt;
}

} // namespace gridspace::ptp
