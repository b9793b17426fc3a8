// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/waited_time.hpp"
#include "timebox/box.hpp"
#include "timebox/call_table.hpp"
#include "timebox/clock_page.hpp"
#include "timebox/look_timer.hpp"
#include "timebox/start.hpp"
#include "timebox/stops.hpp"

#include <list>
#include <sched.h>

namespace gridspace::timebox {

/// The inside of a box. Who runs next: schedule.cpp; what the threads do: events.cpp.
struct Box::Impl {
    Impl(BoxOptions o, Started started, UniqueFd channel);
    ~Impl();
    Impl(Impl const&) = delete;
    Impl& operator=(Impl const&) = delete;

    Result<Pause> run_until(std::optional<std::int64_t> limit_ns);
    [[nodiscard]] std::optional<std::int64_t> next_ns();

    using Next = CallTable::Next;
    using State = Thread::State;

    // schedule.cpp
    void exchange();  ///< with what is outside, at this instant
    Thread* choose(); ///< who runs next; null: nobody, for now
    template <class Fits>
    Thread* first(Fits&& fits);
    Thread* first_ready();
    void look_for_signals();
    bool wait_outside();
    [[nodiscard]] bool others_come_first();
    void open_clock(pid_t process); ///< it is about to run
    void close_clock();             ///< it has come to a stop
    [[nodiscard]] std::int64_t last_look_ns();
    void let_go(Thread& t);

    /// The program has ended; its host goes on: others are informed of what it has closed, and calls are answered.
    void run_network();

    // events.cpp
    void begin_image(pid_t tid);
    Thread& add(pid_t tid, pid_t process);
    Thread* find(pid_t tid);
    void resume(Thread& t, Next how);
    void wait_for_event();
    void check_patience();
    void gone(pid_t tid, Thread* t, int status);
    /// Finds out who was killed while standing still: by the end of its process (0: of any), or by somebody's kill().
    void look_for_killed(pid_t process);
    void stopped(Thread& t, Stop const& stop);
    void go_on(Thread& t, Next next);
    void made(Thread const& by);
    [[nodiscard]] bool asked_to_stop();

    /// Program and box take turns: on one processor the hand-over is a switch, on two it is a wake-up of the other.
    void share_a_processor();
    void leave_processor() const;
    /// Alone, where no tick ends: now and then both may go where there is room, and settle there.
    void roam();
    void settle();

    BoxOptions options;
    BoxReport report;
    ProcessNumbers numbers;
    pid_t main, door; ///< door: 0 where there is none
    std::optional<DoorChannel> channel;
    CallTable table;
    ClockPages clock_pages;
    LookTimer timer;
    Stops stops;
    std::list<Thread> threads; ///< as they were made
    std::vector<pid_t> early;
    int threads_made{0}, last{0};
    pid_t running{0};
    bool main_alive{true}, stop{false};
    std::optional<std::int64_t> ended_ns;
    std::optional<std::int64_t> limit_ns, others_due_ns;
    std::uint64_t looks_before{0}; ///< at the clock, when the turn began
    WaitedTime ran, since_limit;
    std::optional<Error> error;
    cpu_set_t allowed{}; ///< processors of this process
    int processor{-1};   ///< on which the program runs
    int until_settled{kRoaming};
    static constexpr int kRoaming = 1000; ///< stops
};

/// "name (number)", for messages.
[[nodiscard]] std::string name_of(pid_t process);

} // namespace gridspace::timebox
