// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/spsc_ring.hpp"
#include "common/time.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace gridspace::sim {

/// What the simulating thread has made and the publishing thread is to write (real time): neither waits, locks or
/// allocates once the ring has been around. What does not fit is lost and counted.
template <class T>
class Outbox {
  public:
    explicit Outbox(std::size_t capacity) : ring_{capacity} {}

    void put(SimTime time, T const& value) { lost_ += ring_.push({time, value}) ? 0 : 1; }

    /// Hands everything up to `until` to `write(T const&, SimTime)`, in its order.
    template <class Write>
    void drain(SimTime until, Write&& write) {
        for (Entry const* entry = ring_.front(); entry != nullptr && entry->time <= until; entry = ring_.front()) {
            write(entry->value, entry->time);
            ring_.drop();
        }
    }
    [[nodiscard]] std::uint64_t lost() const { return lost_; }

  private:
    struct Entry {
        SimTime time;
        T value;
    };
    SpscRing<Entry> ring_;
    std::atomic<std::uint64_t> lost_{0};
};

} // namespace gridspace::sim
