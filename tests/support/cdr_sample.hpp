// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gridspace {

/// Little-endian XCDR1, written member by member.
class CdrSample {
  public:
    template <class T>
    void number(T value) {
        octets_.resize((octets_.size() - 4 + sizeof(T) - 1) / sizeof(T) * sizeof(T) + 4);
        for (std::byte const b : std::bit_cast<std::array<std::byte, sizeof(T)>>(value)) {
            octets_.push_back(b);
        }
    }
    void text(std::string const& value) {
        number(static_cast<std::uint32_t>(value.size() + 1));
        for (char const c : value) {
            octets_.push_back(static_cast<std::byte>(c));
        }
        octets_.push_back(std::byte{0});
    }
    [[nodiscard]] std::vector<std::byte> const& octets() const { return octets_; }

  private:
    std::vector<std::byte> octets_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

} // namespace gridspace
