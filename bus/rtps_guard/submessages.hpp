// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

#include <optional>

namespace gridspace::rtps_guard {

/// DDSI-RTPS 2.2, 9.4.5.1.1
enum Kind : std::uint8_t {
    kPad = 0x01,
    kAckNack = 0x06,
    kHeartbeat = 0x07,
    kGap = 0x08,
    kInfoTs = 0x09,
    kInfoSrc = 0x0c,
    kInfoReplyIp4 = 0x0d,
    kInfoDst = 0x0e,
    kInfoReply = 0x0f,
    kNackFrag = 0x12,
    kHeartbeatFrag = 0x13,
    kData = 0x15,
    kDataFrag = 0x16,
    kSecureBody = 0x30, // DDS Security 1.1, 7.3.6
    kSecurePrefix = 0x31,
    kSecurePostfix = 0x32,
    kSecureMessagePrefix = 0x33,
    kSecureMessagePostfix = 0x34,
    kStatistics = 0x80, // of Fast DDS, at the end of each of its datagrams
};

constexpr std::size_t kHeader = 20; ///< octets of a message before its first submessage

struct Submessage {
    std::uint8_t kind, flags;
    Octets body;
};

/// The next one of a message; nothing when it reaches beyond the message.
inline std::optional<Submessage> next_submessage(Octets& message) {
    std::uint8_t const kind = message.u8(), flags = message.u8();
    message.little((flags & 1U) != 0);
    std::size_t size = message.u16();
    if (size == 0 && kind != kPad && kind != kInfoTs) {
        size = message.left(); // the last one may leave its length open (9.4.5.1.3)
    }
    auto const body = message.take(size);
    if (!message.ok() || (size % 4 != 0 && message.left() > 0)) {
        return std::nullopt;
    }
    return Submessage{kind, flags, Octets{body, message.little()}};
}

} // namespace gridspace::rtps_guard
