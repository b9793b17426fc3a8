// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/parameter_guard.hpp"

#include "bus/rtps_guard/token_guard.hpp"

#include <algorithm>

namespace gridspace::rtps_guard {
namespace {

enum Pid : std::uint16_t {
    kSentinel = 0x0001,
    kTopicName = 0x0005,
    kTypeName = 0x0007,
    kPartition = 0x0029,
    kUserData = 0x002c,
    kGroupData = 0x002d,
    kTopicData = 0x002e,
    kContentFilter = 0x0035,
    kParticipantGuid = 0x0050,
    kPropertyList = 0x0059,
    kEndpointGuid = 0x005a,
    kEntityName = 0x0062,
    kTypeIdV1 = 0x0069,
    kKeyHash = 0x0070,
    kTypeObjectV1 = 0x0072,
    kDataRepresentation = 0x0073,
    kTypeInformation = 0x0075,
    kIdentityToken = 0x1001,
    kPermissionsToken = 0x1002,
    kEndpointSecurity = 0x1004,
    kParticipantSecurity = 0x1005,
    kIdentityStatusToken = 0x1006,
    kDataSharing = 0x8006,
};

constexpr std::size_t kGuid = 16;
constexpr std::uint32_t kLongestName = 256; // with its NUL: what the library's fixed strings hold

bool is_of_security(std::uint16_t pid) {
    return pid == kIdentityToken || pid == kPermissionsToken || pid == kEndpointSecurity || pid == kParticipantSecurity;
}

bool becomes_padding(std::uint16_t pid, bool secured) {
    return pid == kTypeIdV1 || pid == kTypeObjectV1 || pid == kTypeInformation || pid == kContentFilter ||
           pid == kDataSharing ||
           (pid >= kIdentityToken && pid <= kIdentityStatusToken && !(secured && is_of_security(pid)));
}

/// A length, so many characters, the last one a NUL, and padding.
bool is_string(Octets& value, std::uint32_t longest) {
    std::uint32_t const size = value.u32();
    auto const text = value.take(size);
    value.align();
    return value.ok() && size <= longest && (size == 0 || text.back() == 0);
}

bool are_strings(Octets& value, std::uint32_t in_each, std::uint32_t longest) {
    std::uint32_t const count = value.u32();
    for (std::uint32_t i = 0; value.ok() && i < count; ++i) { // each takes octets: this ends with them
        for (std::uint32_t k = 0; k < in_each; ++k) {
            if (!is_string(value, longest)) {
                return false;
            }
        }
    }
    return value.ok();
}

bool is_sound(std::uint16_t pid, Octets value) {
    switch (pid) {
    case kTopicName:
    case kTypeName:
    case kEntityName:
        return is_string(value, kLongestName);
    case kPartition:
        return are_strings(value, 1, kLongestName);
    case kPropertyList:
        return are_strings(value, 2, UINT32_MAX);
    case kUserData:
    case kGroupData:
    case kTopicData:
        value.skip(value.u32());
        return value.ok();
    case kDataRepresentation:
        value.skip(std::size_t{2} * value.u32());
        return value.ok();
    case kParticipantGuid:
    case kEndpointGuid:
    case kKeyHash:
        return value.left() == kGuid;
    case kIdentityToken:
    case kPermissionsToken:
        return take_data_holder(value);
    case kEndpointSecurity:
    case kParticipantSecurity:
        return value.left() == 8;
    default:
        return true;
    }
}

} // namespace

std::optional<ParameterFacts> examine_parameters(Octets list, bool discovery, bool secured) {
    ParameterFacts out;
    std::size_t const begin = list.at();
    while (true) {
        auto const id = list.take(2);
        std::size_t const size = list.u16();
        if (!list.ok()) {
            return std::nullopt; // no sentinel
        }
        auto const pid = static_cast<std::uint16_t>(list.little() ? id[0] | (id[1] << 8U) : id[1] | (id[0] << 8U));
        if (pid == kSentinel) {
            out.octets = list.at() - begin;
            return out;
        }
        auto const octets = list.take(size);
        if (!list.ok() || size % 4 != 0) {
            return std::nullopt;
        }
        if (discovery && becomes_padding(pid, secured)) {
            std::ranges::fill(id, std::uint8_t{0});
            continue;
        }
        if ((discovery || !is_of_security(pid)) && !is_sound(pid, Octets{octets, list.little()})) {
            return std::nullopt;
        }
        if (pid == kParticipantGuid || pid == kEndpointGuid || pid == kKeyHash) {
            auto& fact = pid == kParticipantGuid ? out.participant : pid == kEndpointGuid ? out.endpoint : out.key;
            GuidPrefix const prefix = Octets{octets}.prefix();
            if (fact && *fact != prefix) {
                return std::nullopt; // two opinions: which of them counts is the reader's choice
            }
            fact = prefix;
        }
    }
}

} // namespace gridspace::rtps_guard
