// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/box.hpp"

#include "timebox/call_table.hpp"
#include "timebox/start.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <list>
#include <sys/ptrace.h>
#include <sys/time.h>
#include <sys/wait.h>

namespace gridspace::timebox {
namespace {

volatile std::sig_atomic_t stop_signal = 0;

/// While it lives, waitpid() returns once a second, and at Ctrl-C.
class Alarms {
  public:
    Alarms() {
        stop_signal = 0;
        struct sigaction look{}, stop{};
        look.sa_handler = [](int) {};
        stop.sa_handler = [](int signal) { stop_signal = signal; };
        ::sigaction(SIGALRM, &look, &before_[0]);
        ::sigaction(SIGINT, &stop, &before_[1]);
        ::sigaction(SIGTERM, &stop, &before_[2]);
        itimerval const each_second{{1, 0}, {1, 0}};
        ::setitimer(ITIMER_REAL, &each_second, nullptr);
    }
    ~Alarms() {
        itimerval const off{};
        ::setitimer(ITIMER_REAL, &off, nullptr);
        ::sigaction(SIGALRM, &before_[0], nullptr);
        ::sigaction(SIGINT, &before_[1], nullptr);
        ::sigaction(SIGTERM, &before_[2], nullptr);
    }
    Alarms(Alarms const&) = delete;
    Alarms& operator=(Alarms const&) = delete;

  private:
    std::array<struct sigaction, 3> before_{};
};

pid_t process_of(pid_t tid) {
    std::ifstream status{fmt::format("/proc/{}/status", tid)};
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("Tgid:")) {
            return std::stoi(line.substr(5));
        }
    }
    return tid;
}

std::string name_of(pid_t process) {
    std::ifstream file{fmt::format("/proc/{}/comm", process)};
    std::string out;
    std::getline(file, out);
    return fmt::format("{} ({})", out, process);
}

class Box {
  public:
    Box(BoxOptions const& options, pid_t first)
        : options_{options}, main_{first}, table_{options.seed, options.epoch_unix_s, report_} {
        add(first, first);
        prepare_image(first, table_.random_octets());
    }

    Result<BoxReport> run() {
        while (main_alive_ && !error_ && stop_signal == 0) {
            Thread* const next = choose();
            if (next == nullptr) {
                break;
            }
            let_go(*next);
        }
        end_all();
        if (error_) {
            return std::unexpected{*error_};
        }
        if (stop_signal != 0) {
            return fail(ExitCode::interrupted, "interrupted");
        }
        report_.simulated_ns = table_.clock().now_ns();
        report_.threads = threads_made_;
        return report_;
    }

  private:
    using Next = CallTable::Next;
    using State = Thread::State;

    Thread& add(pid_t tid, pid_t process) {
        Thread t;
        t.tid = tid;
        t.process = process;
        t.number = ++threads_made_;
        threads_.push_back(t);
        return threads_.back();
    }

    Thread* find(pid_t tid) {
        auto const it = std::find_if(threads_.begin(), threads_.end(), [&](Thread const& t) { return t.tid == tid; });
        return it == threads_.end() ? nullptr : &*it;
    }

    /// Who runs next. Null: the box has come to its end.
    Thread* choose() {
        while (!error_ && stop_signal == 0) {
            SimulatedClock& clock = table_.clock();
            table_.timers().ring(clock.now_ns(), [&](pid_t process) {
                ::kill(process, SIGALRM);
                table_.signalled().insert(process);
            });
            look_for_signals();
            if (Thread* const t = first([&](Thread const& x) {
                    return x.state == State::standing || (x.state == State::held && table_.may_go(x));
                })) {
                return t;
            }
            if (Thread* const t =
                    first([&](Thread const& x) { return x.state == State::held && table_.descriptors_ready(x); })) {
                return t;
            }
            table_.futexes().wake_changed(
                [&](Futexes::Place const& place) { return value_at<std::uint32_t>(place.process, place.address); });
            if (Thread* const t = first([&](Thread const& x) { return x.state == State::held && table_.may_go(x); })) {
                return t;
            }
            if (std::any_of(threads_.begin(), threads_.end(),
                            [](Thread const& t) { return t.state == State::in_fork; })) {
                wait_for_event();
                continue;
            }
            std::optional<std::int64_t> next = table_.timers().next_ns();
            for (Thread const& t : threads_) {
                if (t.state == State::held && t.deadline_ns) {
                    next = std::min(next.value_or(*t.deadline_ns), *t.deadline_ns);
                }
            }
            if (next && options_.until_ns && *next > *options_.until_ns) {
                clock.elapse_to(*options_.until_ns);
                report_.until_reached = true;
                return nullptr;
            }
            if (next) {
                clock.elapse_to(*next);
            } else if (!wait_outside()) {
                return nullptr;
            }
        }
        return nullptr;
    }

    /// In turn, beginning behind the one that ran last.
    template <class Fits>
    Thread* first(Fits&& fits) {
        Thread* before = nullptr;
        for (Thread& t : threads_) {
            if (fits(t)) {
                if (t.number > last_) {
                    return &t;
                }
                before = before == nullptr ? &t : before;
            }
        }
        return before;
    }

    void look_for_signals() {
        if (table_.signalled().empty()) {
            return;
        }
        bool const anybody = table_.signalled().contains(0);
        for (Thread& t : threads_) {
            if (t.state == State::held && (anybody || table_.signalled().contains(t.process))) {
                t.interrupted = table_.has_signal(t);
            }
        }
        table_.signalled().clear();
    }

    /// Nothing in the box will happen by itself: something may come from outside.
    bool wait_outside() {
        constexpr int kLookAgainMs = 100;
        bool anything = false;
        for (Thread const& t : threads_) {
            if (t.state == State::held && !t.interests.empty()) {
                anything = true;
                if (table_.descriptors(t.process).wait_outside(t.interests, kLookAgainMs)) {
                    return true;
                }
            }
        }
        if (!anything) {
            std::string waits;
            for (Thread const& t : threads_) {
                waits += fmt::format("{}{} in {}", waits.empty() ? "" : ", ", name_of(t.process),
                                     t.what != nullptr ? t.what->name : "?");
            }
            error_ = Error{ExitCode::stall,
                           fmt::format("nothing can happen any more at {:.9f} s: {}",
                                       static_cast<double>(table_.clock().now_ns()) / 1e9, waits),
                           "they wait for each other"};
        }
        return anything;
    }

    void resume(Thread& t, Next how) {
        running_ = t.tid;
        began_ = std::chrono::steady_clock::now();
        t.state = State::standing;
        ::ptrace(how == Next::go_to_exit ? PTRACE_SYSCALL : PTRACE_CONT, t.tid, nullptr, std::exchange(t.signal, 0));
    }

    /// Until it waits, or is gone.
    void let_go(Thread& t) {
        last_ = t.number;
        Next how = Next::go;
        if (t.state == State::held) {
            if (options_.on_held && !t.made_again) {
                options_.on_held(static_cast<double>(table_.clock().now_ns()) / 1e9, t.number, t.what->name,
                                 static_cast<double>(table_.clock().now_ns() - t.since_ns) / 1e9);
            }
            how = table_.release(t);
        }
        resume(t, how);
        while (running_ != 0 && !error_ && stop_signal == 0) {
            wait_for_event();
        }
    }

    void wait_for_event() {
        int status = 0;
        pid_t const tid = ::waitpid(-1, &status, __WALL);
        if (tid < 0) {
            if (errno == EINTR) {
                check_patience();
            } else { // nobody is left
                running_ = 0;
                main_alive_ = false;
            }
            return;
        }
        Thread* const t = find(tid);
        if (WIFEXITED(status) || WIFSIGNALED(status)) {
            gone(tid, t, status);
        } else if (t == nullptr) {
            early_.push_back(tid); // the event of its maker comes behind
        } else {
            stopped(*t, status);
        }
    }

    void check_patience() {
        std::chrono::duration<double> const ran = std::chrono::steady_clock::now() - began_;
        Thread const* const t = running_ != 0 ? find(running_) : nullptr;
        if (t != nullptr && ran.count() > options_.patience_s) {
            error_ = Error{
                ExitCode::stall,
                fmt::format(
                    "{} has computed for {:.0f} s without a call that waits or asks for the time; its last was {}",
                    name_of(t->process), ran.count(), t->what != nullptr ? t->what->name : "none"),
                "--patience allows more"};
        }
    }

    void gone(pid_t tid, Thread* t, int status) {
        running_ = running_ == tid ? 0 : running_;
        if (tid == main_) {
            main_alive_ = false;
            report_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        }
        if (t == nullptr) {
            return;
        }
        table_.futexes().leave(tid);
        if (tid == t->process) {
            table_.forget(tid);
            table_.signalled().insert(0); // SIGCHLD
            for (Thread& other : threads_) {
                other.child_ended =
                    other.child_ended || (other.what != nullptr && other.what->treatment == Treatment::child);
            }
        }
        threads_.remove_if([&](Thread const& x) { return x.tid == tid; });
    }

    void stopped(Thread& t, int status) {
        int const event = status >> 16, signal = WSTOPSIG(status);
        if (event == PTRACE_EVENT_SECCOMP) {
            go_on(t, table_.enter(t));
        } else if (signal == (SIGTRAP | 0x80)) {
            go_on(t, table_.leave(t));
        } else if (event == PTRACE_EVENT_CLONE || event == PTRACE_EVENT_FORK || event == PTRACE_EVENT_VFORK) {
            made(t);
            resume(t, Next::go);
            if (event == PTRACE_EVENT_VFORK) {
                t.state = State::in_fork;
                running_ = 0;
            }
        } else if (event == PTRACE_EVENT_VFORK_DONE) {
            t.state = State::standing;
        } else if (event == PTRACE_EVENT_EXEC) {
            threads_.remove_if([&](Thread const& x) { return x.process == t.process && x.tid != t.tid; });
            table_.forget_image(t.process);
            prepare_image(t.tid, table_.random_octets());
            resume(t, Next::go);
        } else if (signal == SIGSEGV &&
                   answer_tick_counter(t.tid, static_cast<std::uint64_t>(table_.clock().now_ns()))) {
            table_.clock().look();
            resume(t, Next::go);
        } else {
            t.signal = event != 0 ? 0 : signal;
            resume(t, Next::go);
        }
    }

    void go_on(Thread& t, Next next) {
        if (next == Next::hold) {
            t.state = State::held;
            running_ = 0;
        } else if (next == Next::let_others_go) {
            t.state = State::standing;
            running_ = 0;
        } else {
            resume(t, next);
        }
    }

    /// A thread has made another one, which stands before its first instruction.
    void made(Thread const& by) {
        unsigned long message = 0;
        ::ptrace(PTRACE_GETEVENTMSG, by.tid, nullptr, &message);
        auto const tid = static_cast<pid_t>(message);
        if (auto const it = std::find(early_.begin(), early_.end(), tid); it != early_.end()) {
            early_.erase(it);
        } else {
            int status = 0;
            while (::waitpid(tid, &status, __WALL) < 0 && errno == EINTR) {
            }
        }
        pid_t const process = process_of(tid);
        if (process != by.process) {
            table_.timers().forked(by.process, process);
        }
        add(tid, process);
    }

    void end_all() {
        for (Thread const& t : threads_) {
            ::kill(t.process, SIGKILL);
        }
        for (int status = 0; ::waitpid(-1, &status, __WALL) > 0 || errno == EINTR;) {
        }
    }

    BoxOptions const& options_;
    BoxReport report_;
    pid_t main_;
    CallTable table_;
    std::list<Thread> threads_; ///< as they were made
    std::vector<pid_t> early_;
    int threads_made_{0}, last_{0};
    pid_t running_{0};
    bool main_alive_{true};
    std::chrono::steady_clock::time_point began_;
    std::optional<Error> error_;
};

} // namespace

Result<BoxReport> run_in_simulated_time(BoxOptions const& options) {
    Alarms const alarms;
    auto const first = start_traced(options.command);
    if (!first) {
        return std::unexpected{first.error()};
    }
    return Box{options, *first}.run();
}

} // namespace gridspace::timebox
