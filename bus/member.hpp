// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "bus/tick_grid.hpp"

namespace gridspace::bus {

/// What a process does when it is its turn. The loop around it, in lockstep and in real time, is run_member.
class Member {
  public:
    virtual ~Member() = default;
    /// Opens readers, writers and signals; before anybody waits for anybody.
    [[nodiscard]] virtual Result<void> prepare() = 0;
    /// Once, in the first tick.
    virtual void begin(Tick const& /*tick*/) {}
    /// Everything up to tick.time that it reads has come. The last one is tick.final.
    [[nodiscard]] virtual Result<void> work(Tick const& tick) = 0;
    /// Lockstep: the next tick in which it wants to work although nothing comes that wakes it.
    [[nodiscard]] virtual std::uint64_t next_tick(Tick const& /*tick*/) const { return TickGrid::kNever; }
    /// Real time: when it wants to work although nothing comes. Nothing: whenever the clock advances.
    [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> deadline() const { return std::nullopt; }
    /// There will be no more ticks; the run has ended, or a stop was asked for.
    virtual void end(Tick const& /*last*/) {}
};

/// The life of a member: prepare, start, tick after tick, end.
[[nodiscard]] Result<void> run_member(Node& node, Member& member);

} // namespace gridspace::bus
