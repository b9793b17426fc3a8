// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/descriptors.hpp"
#include "timebox/held_calls.hpp"
#include "timebox/tracee.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gridspace::timebox {

/// One thread in the box. All but one stand still.
struct Thread {
    pid_t tid{0}, process{0};
    int number{0}; ///< 1, 2, ... as they were made

    enum class State {
        standing, ///< it may run
        held,     ///< in a call, see below
        in_fork,  ///< vfork: the kernel holds it until its child has a program of its own
    } state{State::standing};
    int signal{0};     ///< to be delivered when it runs
    bool dying{false}; ///< it has been killed where it stood; its end is yet to be told

    // The call that it is held in, or that is being tried:
    Call call;
    HeldCall const* what{nullptr};
    std::optional<std::int64_t> deadline_ns;
    std::vector<Interest> interests;
    std::uint64_t signal_mask_at{0}; ///< of a wait for descriptors; 0: the thread's own
    std::int64_t since_ns{0};
    bool interrupted{false}; ///< a signal has come
    bool child_ended{false};
    bool made_again{false}; ///< it stands before the call, not in it

    /// What to do when the call that was let through comes back.
    enum class OnExit {
        nothing,
        wait_or_restore,
        new_timer,
        new_packet_socket,
        ring_mapped,
        new_ip_socket,
        ip_accepted,
    } on_exit{OnExit::nothing};
    std::size_t progress{0}; ///< octets of a stream that the call has sent or received so far
    std::uint32_t room{0};   ///< accept: for the address
};

} // namespace gridspace::timebox
