// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the threads of a box do, as ptrace(2) reports it.
#include "timebox/box_impl.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <string_view>
#include <sys/ptrace.h>
#include <sys/wait.h>

namespace gridspace::timebox {
namespace {

/// What /proc has of a thread, after its key; nothing: it is gone.
std::string told_of(pid_t tid, std::string_view key) {
    std::ifstream status{fmt::format("/proc/{}/status", tid)};
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with(key)) {
            return line.substr(line.find_first_not_of(" \t", key.size()));
        }
    }
    return {};
}

pid_t process_of(pid_t tid) {
    std::string const process = told_of(tid, "Tgid:");
    return process.empty() ? tid : std::stoi(process);
}

/// Whether a thread that stood still stands: nothing but its end makes it go on without us. One in a notified call
/// that is killed has the signal before it leaves the call, and that before it looks at the signal.
bool stands(pid_t tid) {
    if (std::string const pending = told_of(tid, "SigPnd:"); is_notified(tid)) {
        bool const killed = pending.empty() || (std::stoull(pending, nullptr, 16) & (1ULL << (SIGKILL - 1))) != 0;
        return !killed && waits_for_answer(tid);
    }
    return told_of(tid, "State:").starts_with('t') || told_of(tid, "State:").starts_with('T');
}

} // namespace

std::string name_of(pid_t process) {
    std::ifstream file{fmt::format("/proc/{}/comm", process)};
    std::string out;
    std::getline(file, out);
    return fmt::format("{} ({})", out, process);
}

Thread& Box::Impl::add(pid_t tid, pid_t process) {
    Thread t;
    t.tid = tid;
    t.process = process;
    t.number = ++threads_made;
    threads.push_back(t);
    return threads.back();
}

Thread* Box::Impl::find(pid_t tid) {
    auto const it = std::find_if(threads.begin(), threads.end(), [&](Thread const& t) { return t.tid == tid; });
    return it == threads.end() ? nullptr : &*it;
}

/// A program stands before its first instruction.
void Box::Impl::begin_image(pid_t tid) {
    std::uint64_t const vdso = prepare_image(tid, table.random_octets());
    if (!options.looks_in_program || !clock_pages.install(tid, vdso)) {
        take_vdso(tid);
        return;
    }
    ClockPage* const page = clock_pages.begin(tid);
    for (std::size_t clock = 0; clock < page->offsets_ns.size(); ++clock) {
        page->offsets_ns[clock] = table.clock().reading_ns(static_cast<clockid_t>(clock)) - table.clock().now_ns();
    }
}

void Box::Impl::resume(Thread& t, Next how) {
    running = t.tid;
    ran.restart();
    t.state = State::standing;
    open_clock(t.process);
    let_run(t.tid, how == Next::go_to_exit ? GoOn::to_exit : GoOn::run, std::exchange(t.signal, 0));
}

bool Box::Impl::asked_to_stop() {
    return options.stop && options.stop();
}

void Box::Impl::wait_for_event() {
    Stop told;
    switch (stops.wait(told)) {
    case Stops::Why::interrupted:
        stop = stop || asked_to_stop();
        check_patience();
        roam();
        return;
    case Stops::Why::nobody_is_left:
        running = 0;
        main_alive = false;
        return;
    case Stops::Why::stop:
        break;
    }
    settle();
    Thread* const t = find(told.tid);
    if (Thread const* const ran_last = find(running);
        ran_last != nullptr && t != nullptr && t->process == ran_last->process) {
        close_clock(); // an exec of another thread is reported as the first one's
    }
    if (!told.call && (WIFEXITED(told.status) || WIFSIGNALED(told.status))) {
        gone(told.tid, t, told.status);
    } else if (t == nullptr) {
        early.push_back(told.tid); // the event of its maker comes behind
    } else {
        stopped(*t, told);
    }
}

void Box::Impl::check_patience() {
    double const computed_s = ran.look().count(), busy_s = since_limit.look().count();
    Thread const* const t = running != 0 ? find(running) : nullptr;
    if (t == nullptr || error) {
        return;
    }
    std::string const last_call = t->what != nullptr ? t->what->name : "none";
    if (options.patience_s > 0 && computed_s > options.patience_s) {
        error = Error{ExitCode::stall,
                      fmt::format("{} has computed for {:.0f} s without a call that waits or asks for the time, at "
                                  "{:.9f} s of simulated time; its last was {}",
                                  name_of(t->process), computed_s, static_cast<double>(table.clock().now_ns()) / 1e9,
                                  last_call),
                      options.link ? "`clock: {member_timeout_s: ...}` allows more" : "--patience allows more"};
    } else if (options.rest_s > 0 && busy_s > options.rest_s && limit_ns) {
        error = Error{ExitCode::stall,
                      fmt::format("{} has not come to rest at {:.9f} s of simulated time within {:.0f} s: it has made "
                                  "{} calls so far, the last was {}",
                                  name_of(t->process), static_cast<double>(table.clock().now_ns()) / 1e9, busy_s,
                                  report.held + report.clock_reads, last_call),
                      "does it wait by looking again and again? `clock: {member_timeout_s: ...}` allows more"};
    }
}

void Box::Impl::gone(pid_t tid, Thread* t, int status) {
    running = running == tid ? 0 : running;
    forget_tracee(tid);
    if (tid == main) {
        main_alive = false;
        ended_ns = table.clock().now_ns();
        report.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        report.last_call = t != nullptr && t->what != nullptr ? t->what->name : "none";
    }
    if (tid == door && main_alive) {
        error = Error{ExitCode::child_died,
                      fmt::format("the door of DDS has ended ({})",
                                  WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status))
                                                    : fmt::format("signal {}", WTERMSIG(status))),
                      "the log of the process says why"};
    }
    if (t == nullptr) {
        return;
    }
    table.futexes().leave(tid);
    if (tid == t->process) {
        table.forget(tid);
        clock_pages.forget(tid);
        table.signalled().insert(0); // SIGCHLD
        for (Thread& other : threads) {
            other.child_ended =
                other.child_ended || (other.what != nullptr && other.what->treatment == Treatment::child);
        }
    }
    pid_t const process = t->process;
    threads.remove_if([&](Thread const& x) { return x.tid == tid; });
    look_for_killed(process); // exit_group() of this one is the end of all
}

void Box::Impl::look_for_killed(pid_t process) {
    for (Thread& t : threads) {
        bool const asked = process == 0 || t.process == process;
        if (asked && t.tid != running && t.state != State::in_fork && !stands(t.tid)) {
            t.dying = true;
        }
    }
}

void Box::Impl::stopped(Thread& t, Stop const& told) {
    int const event = told.status >> 16, signal = WSTOPSIG(told.status);
    if (channel) {
        channel->exchange(table.clock().now_ns()); // what it sent is of before this stop
    }
    if (told.call || event == PTRACE_EVENT_SECCOMP) {
        go_on(t, table.enter(t));
    } else if (signal == (SIGTRAP | 0x80)) {
        go_on(t, table.leave(t));
    } else if (event == PTRACE_EVENT_CLONE || event == PTRACE_EVENT_FORK || event == PTRACE_EVENT_VFORK) {
        made(t);
        resume(t, Next::go);
        if (event == PTRACE_EVENT_VFORK) {
            t.state = State::in_fork;
            running = 0;
        }
    } else if (event == PTRACE_EVENT_VFORK_DONE) {
        t.state = State::standing;
    } else if (event == PTRACE_EVENT_EXEC) {
        threads.remove_if([&](Thread const& x) {
            bool const over = x.process == t.process && x.tid != t.tid;
            if (over) {
                forget_tracee(x.tid);
            }
            return over;
        });
        forget_tracee(t.tid);
        t.dying = false; // when another thread did it, that one has the first one's number now
        table.forget_image(t.process);
        begin_image(t.tid);
        resume(t, Next::go);
    } else if (signal == SIGSEGV && answer_tick_counter(t.tid, static_cast<std::uint64_t>(table.clock().now_ns()))) {
        table.clock().look();
        resume(t, Next::go);
    } else {
        t.signal = event != 0 ? 0 : signal;
        resume(t, Next::go);
    }
}

void Box::Impl::go_on(Thread& t, Next next) {
    if (next == Next::go && others_come_first()) {
        next = Next::let_others_go;
    }
    if (next == Next::hold) {
        t.state = State::held;
        running = 0;
    } else if (next == Next::let_others_go) {
        t.state = State::standing;
        running = 0;
    } else {
        resume(t, next);
    }
}

/// A thread has made another one, which stands before its first instruction.
void Box::Impl::made(Thread const& by) {
    unsigned long message = 0;
    ::ptrace(PTRACE_GETEVENTMSG, by.tid, nullptr, &message);
    auto const tid = static_cast<pid_t>(message);
    if (auto const it = std::find(early.begin(), early.end(), tid); it != early.end()) {
        early.erase(it);
    } else {
        int status = 0;
        while (::waitpid(tid, &status, __WALL) < 0 && errno == EINTR) {
        }
    }
    pid_t const process = process_of(tid);
    if (process != by.process) {
        table.timers().forked(by.process, process);
        clock_pages.forked(by.process, process);
    }
    add(tid, process);
}

} // namespace gridspace::timebox
