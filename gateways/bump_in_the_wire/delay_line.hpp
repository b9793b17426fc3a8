// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gridspace::gateways {

/// Frames that wait for their time. They leave in the order of time, and in the order in which they came at equal
/// times. Pure; no allocation once as many frames as ever have waited.
class DelayLine {
  public:
    /// `capacity`: more do not wait, they are lost.
    explicit DelayLine(std::size_t capacity) : capacity_{capacity} {}

    /// False: it is full.
    bool push(std::int64_t at_ns, std::span<std::uint8_t const> octets);

    struct Waiting {
        std::int64_t at_ns{0};
        std::span<std::uint8_t const> octets; ///< valid until the next push
    };
    /// The next one, when its time is not after `until_ns`.
    [[nodiscard]] std::optional<Waiting> pop(std::int64_t until_ns);
    [[nodiscard]] std::optional<std::int64_t> next_ns() const;
    [[nodiscard]] std::size_t size() const { return heap_.size(); }

  private:
    struct Entry {
        std::int64_t at_ns;
        std::uint64_t order;
        std::size_t slot;
        friend bool operator>(Entry const& a, Entry const& b) {
            return a.at_ns != b.at_ns ? a.at_ns > b.at_ns : a.order > b.order;
        }
    };
    std::size_t capacity_;
    std::uint64_t order_{0};
    std::vector<Entry> heap_; ///< the earliest in front
    std::vector<std::vector<std::uint8_t>> slots_;
    std::vector<std::size_t> free_;
};

} // namespace gridspace::gateways
