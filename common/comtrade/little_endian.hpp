// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace gridspace {

/// Appends the lowest `octets` of `value`, lowest first: how a binary .dat file has its numbers (IEC 60255-24).
inline void put(std::string& out, std::uint32_t value, int octets) {
    for (int i = 0; i < octets; ++i) {
        out.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
    }
}

} // namespace gridspace
