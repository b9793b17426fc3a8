// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/gathered_message.hpp"

#include <algorithm>

namespace gridspace::bus {
namespace {

constexpr std::size_t kHeaderSize = 20; // "RTPS", version, vendor, GUID prefix
constexpr std::uint8_t kInfoTs = 0x09, kInfoDst = 0x0e;
// A vendor's submessage that ends every datagram of Fast DDS. Its UDP transport fills it in by position: it looks for
// this octet at a fixed distance from the end, so a message without it may have its payload overwritten. A merged
// message therefore ends in exactly one.
constexpr std::uint8_t kStatistics = 0x80;

} // namespace

MessageParts parts_of(std::span<std::uint8_t const> message) {
    constexpr std::array<std::uint8_t, 9> kPlain{
        0x06 /*ACKNACK*/, 0x07 /*HEARTBEAT*/, 0x08 /*GAP*/,        kInfoTs, kInfoDst,
        0x15 /*DATA*/,    0x30 /*SEC_BODY*/,  0x31 /*SEC_PREFIX*/, 0x32 /*SEC_POSTFIX*/}; // these three stay together
    MessageParts parts;
    std::size_t at = kHeaderSize;
    while (at + 4 <= message.size()) {
        std::uint8_t const id = message[at];
        bool const little = (message[at + 1] & 1U) != 0;
        std::size_t const length =
            little ? message[at + 2] | (message[at + 3] << 8U) : message[at + 3] | (message[at + 2] << 8U);
        if (id == kStatistics && at + 4 + length == message.size()) {
            break;
        }
        bool const has_no_body = id == kInfoTs && (message[at + 1] & 2U) != 0; // one that invalidates
        if (std::find(kPlain.begin(), kPlain.end(), id) == kPlain.end() || (length == 0 && !has_no_body) ||
            at + 4 + length > message.size()) {
            return parts;
        }
        if (id == kInfoDst) {
            auto const named = message.subspan(at + 4, length);
            if (length != parts.destination.size() ||
                (parts.directed && !std::ranges::equal(parts.destination, named))) {
                return parts;
            }
            std::ranges::copy(named, parts.destination.begin());
            parts.directed = true;
        }
        at += 4 + length;
    }
    if (message.size() < kHeaderSize) {
        return parts;
    }
    parts.header = message.first(kHeaderSize);
    parts.submessages = message.subspan(kHeaderSize, at - kHeaderSize);
    parts.statistics = message.subspan(at);
    parts.mergeable = true;
    return parts;
}

bool GatheredMessage::takes(MessageParts const& parts, std::size_t longest) const {
    // An INFO_DST stays in force until the next one.
    return directed_ == parts.directed && destination_ == parts.destination &&
           octets_.size() + parts.submessages.size() + parts.statistics.size() <= longest &&
           std::ranges::equal(parts.header, std::span{octets_}.first(kHeaderSize));
}

void GatheredMessage::add(MessageParts const& parts) {
    if (octets_.empty()) {
        octets_.assign(parts.header.begin(), parts.header.end());
        directed_ = parts.directed;
        destination_ = parts.destination;
    }
    octets_.insert(octets_.end(), parts.submessages.begin(), parts.submessages.end());
    statistics_.assign(parts.statistics.begin(), parts.statistics.end());
}

MessageParts GatheredMessage::parts() const {
    std::span const octets{octets_};
    return {true, octets.first(kHeaderSize), octets.subspan(kHeaderSize), statistics_, directed_, destination_};
}

std::span<std::uint8_t const> GatheredMessage::finish() {
    octets_.insert(octets_.end(), statistics_.begin(), statistics_.end());
    return octets_;
}

void GatheredMessage::clear() {
    octets_.clear();
}

} // namespace gridspace::bus
