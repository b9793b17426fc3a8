// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gridspace::lockstep {

/// The addresses that `gridspace run` gives begin with these three octets: locally administered, "GS".
inline constexpr std::array<std::uint8_t, 3> kRunAddressOctets{0x02, 0x47, 0x53};
inline constexpr std::uint64_t kRunAddressPrefix = 0x024753;

/// The source address of a frame, as a number of 48 bits; 0 when the frame is too short to have one.
[[nodiscard]] std::uint64_t source_of(std::span<std::byte const> frame);

/// Counts frames by source address. Bounded: of so many addresses as it names, and of all others together.
class ForeignFrames {
  public:
    static constexpr std::size_t kNamed = 32;
    struct Source {
        std::uint64_t address{0};
        std::uint64_t frames{0};
    };

    void add(std::uint64_t source);
    [[nodiscard]] std::span<Source const> named() const { return named_; }
    [[nodiscard]] std::uint64_t unnamed() const { return unnamed_; }
    [[nodiscard]] std::uint64_t total() const;
    /// "3000 from 02:00:00:00:00:99, 12 from others", the most frequent first; empty when there are none.
    [[nodiscard]] std::string text() const;

  private:
    std::vector<Source> named_;
    std::uint64_t unnamed_{0};
};

} // namespace gridspace::lockstep
