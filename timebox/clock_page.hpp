// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <sys/types.h>

namespace gridspace::timebox {

/// What a program and its box share of the clock: clock_code.cpp reads it by these offsets.
struct ClockPage {
    std::int64_t now_ns{0};
    std::int64_t last_ns{-1};                  ///< to which a look may bring it; beyond, the call is made
    std::int64_t looks_left{0};                ///< of this turn, likewise
    std::array<std::int64_t, 3> looks{};       ///< that were answered here: clock_gettime, gettimeofday, time
    std::array<std::int64_t, 16> offsets_ns{}; ///< of the clocks, by their number
};

/// Looks at the clock that are answered in the program itself. In each image the functions of the vDSO that read clocks
/// are replaced by ours, which do what the call would: read, and let 100 ns go by. They do so only as long as nothing
/// else could happen meanwhile; otherwise they make the call, and it is answered as ever. One thread of a box runs at a
/// time, so nobody else has the page in hand.
class ClockPages {
  public:
    /// At an exec, before the first instruction; `vdso`: where it is in the image. False: looks go on as calls.
    bool install(pid_t tid, std::uint64_t vdso);
    /// `child` has the memory of `parent`, or a copy of it.
    void forked(pid_t parent, pid_t child);
    void forget(pid_t process) { pages_.erase(process); }

    /// The page of the process that runs now; null: it has none.
    [[nodiscard]] ClockPage* begin(pid_t process);
    /// That one, which has come to a stop.
    [[nodiscard]] ClockPage* end() { return running_.get(); }

  private:
    std::map<pid_t, std::shared_ptr<ClockPage>> pages_;
    std::shared_ptr<ClockPage> running_;
};

} // namespace gridspace::timebox
