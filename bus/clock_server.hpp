// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/lockstep/barrier.hpp"
#include "bus/member_plan.hpp"
#include "bus/node.hpp"

#include <memory>
#include <string>
#include <vector>

namespace gridspace::bus {

/// Publishes the simulation clock and, in lockstep, is the barrier. Used by the simulator, on its node.
class ClockServer {
  public:
    ClockServer(Node& node, std::vector<MemberPlan> members);
    ~ClockServer();

    /// Waits, at most start_timeout_s, until the node and all members are READY.
    [[nodiscard]] Result<void> start();

    /// Real time: simulated time 0 is now; members hear it with every clock sample.
    void set_start(std::int64_t unix_ns);

    /// Publishes tick k = 0, 1, 2 … with the simulated time it grants. What belongs to the tick has been written
    /// before. Lockstep: returns when every awaited member has acknowledged it and everything that they sent to the
    /// simulator has arrived. Real time: returns at once.
    [[nodiscard]] Result<void> tick(SimTime time, bool final);

    /// Holds the barrier until this incarnation of a restarted process, and everybody matched with it, is READY.
    [[nodiscard]] Result<void> await_restarted(std::string const& process, std::uint32_t incarnation);
    /// Goes on without the member, and with it again.
    void drop(std::string const& process);
    void rejoin(std::string const& process);

    /// Informs the members that the run is over before its end.
    void abort();

    [[nodiscard]] std::uint64_t ticks() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace gridspace::bus
