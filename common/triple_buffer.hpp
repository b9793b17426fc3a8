// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <utility>

namespace gridspace {

/// The newest value from one writing to one reading thread. Neither waits, locks or allocates; values in between are
/// skipped.
template <class T>
class TripleBuffer {
  public:
    explicit TripleBuffer(T const& initial) : slots_{initial, initial, initial} {}

    /// Where the writer prepares the next value; publish() hands it over.
    [[nodiscard]] T& back() { return slots_[back_]; }
    void publish() { back_ = shared_.exchange(back_ | kNew, std::memory_order_acq_rel) & kIndex; }

    /// The newest value that was published, for the reader.
    [[nodiscard]] T const& front() {
        if ((shared_.load(std::memory_order_relaxed) & kNew) != 0) {
            front_ = shared_.exchange(front_, std::memory_order_acq_rel) & kIndex;
        }
        return slots_[front_];
    }

  private:
    static constexpr std::uint8_t kIndex = 3, kNew = 4;
    std::array<T, 3> slots_;
    alignas(64) std::atomic<std::uint8_t> shared_{1};
    alignas(64) std::uint8_t back_{0};
    alignas(64) std::uint8_t front_{2};
};

} // namespace gridspace
