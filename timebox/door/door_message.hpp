// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/key_hash.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

namespace gridspace::timebox {

/// What member and door say to each other: a sample as CDR behind this. Both are the same program, on one machine.
struct DoorMessage {
    std::uint32_t topic{0}; ///< which, among those that go this way
    std::uint32_t keyed{0}; ///< key_hash counts
    std::int64_t source_ns{0};
    bus::KeyHash key_hash{};
};

[[nodiscard]] inline std::vector<std::byte> to_octets(DoorMessage const& message, std::span<std::byte const> cdr) {
    std::vector<std::byte> out(sizeof message + cdr.size());
    std::memcpy(out.data(), &message, sizeof message);
    if (!cdr.empty()) {
        std::memcpy(out.data() + sizeof message, cdr.data(), cdr.size());
    }
    return out;
}

/// Nothing: it is too short.
[[nodiscard]] inline std::optional<DoorMessage> door_message(std::span<std::byte const> octets) {
    DoorMessage out;
    if (octets.size() < sizeof out) {
        return std::nullopt;
    }
    std::memcpy(&out, octets.data(), sizeof out);
    return out;
}

} // namespace gridspace::timebox
