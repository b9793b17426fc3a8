// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/token_guard.hpp"

namespace gridspace::rtps_guard {
namespace {

constexpr std::uint32_t kMostHolders = 16, kMostProperties = 64; // of a handshake 1 and about 10
constexpr std::size_t kIdentities = 2 * (16 + 8) + 3 * 16;       // of two messages, and three entities

bool take_octets(Octets& octets) {
    std::uint32_t const size = octets.u32();
    octets.skip(size);
    octets.align();
    return octets.ok();
}

/// Pairs of a string and something else that begins with its length as a string does.
bool take_properties(Octets& octets) {
    std::uint32_t const count = octets.u32();
    bool ok = octets.ok() && count <= kMostProperties;
    for (std::uint32_t i = 0; ok && i < count; ++i) {
        ok = take_octets(octets) && take_octets(octets);
    }
    return ok;
}

} // namespace

bool take_data_holder(Octets& octets) {
    return take_octets(octets) && take_properties(octets) && take_properties(octets);
}

bool is_generic_message(Octets payload) {
    auto const encapsulation = payload.take(4);
    if (!payload.ok() || encapsulation[0] != 0 || encapsulation[1] > 1) {
        return false; // CDR_BE or CDR_LE
    }
    Octets message{payload.take(payload.left()), encapsulation[1] == 1}; // aligned from here on
    message.skip(kIdentities);
    std::uint32_t count = 0;
    bool ok = take_octets(message) && (count = message.u32()) <= kMostHolders && message.ok();
    for (std::uint32_t i = 0; ok && i < count; ++i) {
        ok = take_data_holder(message);
    }
    return ok;
}

} // namespace gridspace::rtps_guard
