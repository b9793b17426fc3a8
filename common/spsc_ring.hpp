// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gridspace {

/// A bounded queue between one writing and one reading thread. Neither waits, locks or allocates.
template <class T>
class SpscRing {
  public:
    explicit SpscRing(std::size_t capacity) : slots_(capacity) {}

    /// False when it is full.
    bool push(T const& value) {
        std::uint64_t const at = written_.load(std::memory_order_relaxed);
        if (at - read_.load(std::memory_order_acquire) >= slots_.size()) {
            return false;
        }
        slots_[at % slots_.size()] = value;
        written_.store(at + 1, std::memory_order_release);
        return true;
    }
    /// False when it is empty.
    bool pop(T& out) {
        std::uint64_t const at = read_.load(std::memory_order_relaxed);
        if (at == written_.load(std::memory_order_acquire)) {
            return false;
        }
        out = slots_[at % slots_.size()];
        read_.store(at + 1, std::memory_order_release);
        return true;
    }
    /// The oldest element, which stays; for the reading thread. nullptr when it is empty.
    [[nodiscard]] T const* front() const {
        std::uint64_t const at = read_.load(std::memory_order_relaxed);
        return at == written_.load(std::memory_order_acquire) ? nullptr : &slots_[at % slots_.size()];
    }
    /// Takes the oldest element away, once front() has shown it.
    void drop() { read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }
    [[nodiscard]] bool empty() const {
        return read_.load(std::memory_order_acquire) == written_.load(std::memory_order_acquire);
    }

  private:
    std::vector<T> slots_;
    alignas(64) std::atomic<std::uint64_t> written_{0};
    alignas(64) std::atomic<std::uint64_t> read_{0};
};

} // namespace gridspace
