// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <sys/types.h>
#include <vector>

namespace gridspace::timebox {

/// The threads that wait at a word of memory, in the order in which they came (futex(2)). One runs at a time, so
/// nothing can happen between the look at the word and the wait.
class Futexes {
  public:
    struct Place {
        pid_t process{0};
        std::uint64_t address{0};
        friend bool operator==(Place const&, Place const&) = default;
    };

    void wait(pid_t tid, Place const& place, std::uint32_t expected, std::uint32_t bits) {
        waiting_.push_back({tid, place, expected, bits, false});
    }
    /// Wakes at most `count` of those that wait there for one of `bits`; how many.
    std::int64_t wake(Place const& place, std::uint32_t bits, std::int64_t count) {
        std::int64_t woken = 0;
        for (Waiter& w : waiting_) {
            if (woken < count && !w.woken && w.place == place && (w.bits & bits) != 0) {
                w.woken = true;
                ++woken;
            }
        }
        return woken;
    }
    /// Wakes threads whose word is no longer what they expected: the kernel itself has written it (a thread has
    /// ended), or another process.
    template <class Read>
    void wake_changed(Read&& read) {
        for (Waiter& w : waiting_) {
            w.woken = w.woken || read(w.place) != w.expected;
        }
    }
    [[nodiscard]] bool is_woken(pid_t tid) const {
        return std::any_of(waiting_.begin(), waiting_.end(), [&](Waiter const& w) { return w.tid == tid && w.woken; });
    }
    void leave(pid_t tid) {
        std::erase_if(waiting_, [&](Waiter const& w) { return w.tid == tid; });
    }

  private:
    struct Waiter {
        pid_t tid;
        Place place;
        std::uint32_t expected, bits;
        bool woken;
    };
    std::vector<Waiter> waiting_;
};

} // namespace gridspace::timebox
