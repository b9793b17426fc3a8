// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/clock_server.hpp"
#include "bus/node_core.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace gridspace::bus {

/// Whom the simulator waits for, and why they do not come.
struct ClockServer::State {
    Node& node;
    Node::Core& core;
    std::vector<MemberPlan> plan;
    lockstep::Barrier barrier;
    std::unique_ptr<RawWriter> clock_writer;
    std::unique_ptr<RawReader> status_reader;
    SimClock clock;
    std::uint64_t next_tick{0};
    std::chrono::steady_clock::time_point sent_at; ///< real time: the newest clock sample

    struct Status {
        std::uint32_t incarnation{0};
        MemberState state{MEMBER_STARTING};
        std::map<std::string, std::uint32_t> matched;
        std::string waiting_for;
    };
    std::map<std::string, Status> statuses;            // under core.mutex
    std::map<std::string, std::uint32_t> incarnations; // expected, by process
    std::set<std::string> dropped;                     // the run goes on without them
    std::vector<std::size_t> inputs;                   // processes that feed the simulator, as indices of the book

    struct OnBoard {                       ///< a member of the plan; indices, because they are needed in every tick
        std::size_t place, member;         ///< of the board and of the barrier
        std::vector<std::size_t> upstream; ///< of the barrier: whom it waits for within the tick
    };
    std::vector<OnBoard> on_board; ///< in the plan's order

    static std::vector<lockstep::Barrier::Member> barrier_members(std::vector<MemberPlan> const& plan) {
        std::vector<lockstep::Barrier::Member> members;
        for (MemberPlan const& member : plan) {
            members.push_back({member.name, member.triggered_by, member.late, member.collects_frames});
        }
        return members;
    }

    State(Node& n, Node::Core& c, std::vector<MemberPlan> members)
        : node{n}, core{c}, plan{std::move(members)},
          barrier{barrier_members(plan), static_cast<std::uint64_t>(c.config.clock.max_lag_ticks)} {}

    void on_status(std::span<std::byte const> cdr, SampleHeader const& header);

    /// Who is not READY, or is matched with an incarnation that is gone; whom nobody has heard of comes alone, since
    /// the others wait for it. Under the mutex.
    [[nodiscard]] std::string not_ready() const;

    /// How far the others have come: each peer that one of them is matched with. Under the mutex.
    [[nodiscard]] std::size_t others_present() const;

    [[nodiscard]] bool inputs_complete() const {
        return std::all_of(inputs.begin(), inputs.end(), [&](std::size_t p) { return core.book->complete(p); });
    }

    /// Those at the root of a stall: a member that waits for another missing member is not to blame. Under the mutex.
    [[nodiscard]] std::string culprits() const;

    /// The clock sample with the start of the counts for a new incarnation of `process`. Under the mutex.
    void hold(std::string const& process);

    /// Fills `on_board`.
    void find_places();

    /// The clock on the board, where each awaited member is woken by the last thing that it waits for.
    [[nodiscard]] bool post_clock(SimTime time);

    /// Waits under the deadline of the start for everybody to be READY.
    [[nodiscard]] Result<void> await_ready(std::string const& what);

    /// The steps of ClockServer::tick(). Whether anybody has to hear of this tick.
    [[nodiscard]] bool has_listeners(std::uint64_t number, bool final);
    [[nodiscard]] Result<void> send(SimTime time, std::uint64_t number, bool final);
    void end_in_real_time();
    /// Real time: processes of the run that are here and have not said that they know of the end. Without the mutex.
    [[nodiscard]] bool anybody_has_to_hear_the_end();
    /// Until everybody whom the tick needs has acknowledged it, and what feeds the simulator is complete.
    [[nodiscard]] Result<void> await_members(SimTime time, std::uint64_t number);
    /// False when they do not come within the patience for a member.
    [[nodiscard]] bool await_within_patience(std::unique_lock<std::mutex>& lock);
    [[nodiscard]] bool may_go_on() const {
        return core.error || core.stop_requested || (barrier.complete() && inputs_complete());
    }
};

} // namespace gridspace::bus
