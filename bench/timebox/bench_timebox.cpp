// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a call costs a program in simulated time, and the same program in real time: a clock read, a sleep
// that is over at once, a poll of a pipe that holds something. The same executable is the program. The last line is
// what the kernel takes for a stop of a tracer that does nothing: no held call can take less.
//     bench_timebox [CALLS]
#include "timebox/box.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sched.h>
#include <string>
#include <string_view>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

struct Kind {
    char const* name;
    void (*call)(int pipe);
};
constexpr Kind kKinds[]{
    {"look",
     [](int) {
         timespec now{};
         ::clock_gettime(CLOCK_MONOTONIC, &now);
     }},
    {"sleep",
     [](int) {
         timespec const over{0, 1};
         ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &over, nullptr);
     }},
    {"poll",
     [](int pipe) {
         pollfd ready{pipe, POLLIN, 0};
         ::poll(&ready, 1, 1000);
     }},
};

/// The program: so many calls.
int program(std::string_view kind, long calls) {
    int ends[2];
    if (::pipe(ends) != 0 || ::write(ends[1], "x", 1) != 1) {
        return 1;
    }
    for (Kind const& k : kKinds) {
        for (long i = 0; k.name == kind && i < calls; ++i) {
            k.call(ends[0]);
        }
    }
    return 0;
}

void stay_on_one_processor() {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(::sched_getcpu()), &one);
    ::sched_setaffinity(0, sizeof one, &one);
}

/// So many calls that stop for a tracer, in a program beside it on one processor; the tracer lets each go on.
bool bare_stops(long calls) {
    pid_t const child = ::fork();
    if (child == 0) {
        sock_filter filter[]{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                             BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_getppid, 0, 1),
                             BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE),
                             BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
        sock_fprog const all{std::size(filter), filter};
        bool const ready = ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0 &&
                           ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::raise(SIGSTOP) == 0 &&
                           ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &all) == 0;
        for (long i = 0; ready && i < calls; ++i) {
            ::syscall(SYS_getppid);
        }
        ::_exit(ready ? 0 : 1);
    }
    int status = 0;
    if (::waitpid(child, &status, 0) != child || !WIFSTOPPED(status) ||
        ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESECCOMP | PTRACE_O_EXITKILL) != 0) {
        return false;
    }
    do {
        ::ptrace(PTRACE_CONT, child, nullptr, nullptr);
    } while (::waitpid(child, &status, 0) == child && WIFSTOPPED(status));
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Microseconds a call, median of five; the start is taken off.
template <class Run>
double cost_us(long calls, Run&& run) {
    auto const took = [&](long n) {
        auto const began = Clock::now();
        run(n);
        return std::chrono::duration<double, std::micro>(Clock::now() - began).count();
    };
    std::vector<double> all;
    for (int i = 0; i < 5; ++i) {
        double const start = took(0);
        all.push_back((took(calls) - start) / static_cast<double>(calls));
    }
    std::sort(all.begin(), all.end());
    return all[2];
}

} // namespace

int main(int argc, char** argv) {
    if (argc == 4 && std::string_view{argv[1]} == "program") {
        return program(argv[2], std::strtol(argv[3], nullptr, 10));
    }
    long const calls = argc > 1 ? std::strtol(argv[1], nullptr, 10) : 20'000;
    fmt::print("{:<8} {:>16} {:>20}\n", "call", "real time, us", "simulated time, us");
    for (Kind const& kind : kKinds) {
        double const boxed = cost_us(calls, [&](long n) {
            gridspace::timebox::BoxOptions options;
            options.command = {"/proc/self/exe", "program", kind.name, std::to_string(n)};
            auto const box = gridspace::timebox::Box::start(options);
            if (!box || !(*box)->run_until(std::nullopt)) {
                fmt::print(stderr, "programs cannot run in simulated time here: `gridspace doctor` says why\n");
                std::exit(3);
            }
        });
        double const native = cost_us(calls, [&](long n) { (void)program(kind.name, n); });
        fmt::print("{:<8} {:>16.3f} {:>20.3f}\n", kind.name, native, boxed);
    }
    stay_on_one_processor();
    bool stopped = true;
    double const bare = cost_us(calls, [&](long n) { stopped = bare_stops(n) && stopped; });
    double const native = cost_us(calls, [](long n) {
        for (long i = 0; i < n; ++i) {
            ::syscall(SYS_getppid);
        }
    });
    fmt::print("{:<8} {:>16.3f} {:>20.3f}\n", "stop", native, bare);
    return stopped ? 0 : 1;
}
