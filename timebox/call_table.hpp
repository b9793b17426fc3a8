// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/random.hpp"
#include "timebox/box.hpp"
#include "timebox/futexes.hpp"
#include "timebox/simulated_clock.hpp"
#include "timebox/thread.hpp"
#include "timebox/timers.hpp"

#include <map>
#include <set>

namespace gridspace::timebox {

/// What each call means in simulated time. The threads stand still while it looks at them.
class CallTable {
  public:
    CallTable(std::uint64_t seed, std::int64_t epoch_unix_s, BoxReport& report);

    /// How the thread goes on.
    enum class Next {
        go,            ///< the call is answered, or runs as it is
        go_to_exit,    ///< it runs, and leave() wants to see it come back
        hold,          ///< it waits
        let_others_go, ///< answered; but others come first
    };
    /// The thread is about to make a call.
    Next enter(Thread& t);
    /// The call has come back: `hold` when it has to be made again, later.
    Next leave(Thread& t);
    /// What the thread waits for is there, or its time is over.
    Next release(Thread& t);

    /// Without a look at its descriptors.
    [[nodiscard]] bool may_go(Thread const& t) const;
    [[nodiscard]] bool descriptors_ready(Thread const& t);
    /// A signal that it does not block waits for it.
    [[nodiscard]] bool has_signal(Thread const& t) const;

    [[nodiscard]] SimulatedClock& clock() { return clock_; }
    [[nodiscard]] Timers& timers() { return timers_; }
    [[nodiscard]] Futexes& futexes() { return futexes_; }
    [[nodiscard]] std::set<pid_t>& signalled() { return signalled_; } ///< processes that a signal may have come to
    [[nodiscard]] Descriptors const& descriptors(pid_t process);
    void forget(pid_t process);       ///< it has ended
    void forget_image(pid_t process); ///< it is another program now: its alarm stays
    [[nodiscard]] std::array<std::uint8_t, 16> random_octets();

  private:
    Next answer_clock(Thread& t);
    Next hold_until(Thread& t, std::optional<std::int64_t> deadline_ns);
    Next sleep(Thread& t);
    Next look_at_descriptors(Thread& t);
    Next transfer(Thread& t, short event);
    Next futex(Thread& t);
    Next wait_for_child(Thread& t);
    Next timer(Thread& t);
    Next option(Thread& t);
    Next refuse(Thread& t, std::string const& what, int error);
    /// The call, but without waiting.
    Next try_it(Thread& t);

    SimulatedClock clock_;
    Timers timers_;
    Futexes futexes_;
    Random random_;
    std::map<pid_t, Descriptors> descriptors_;
    std::set<pid_t> signalled_;
    BoxReport& report_;
};

} // namespace gridspace::timebox
