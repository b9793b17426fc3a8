// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/call_guard.hpp"

#include "common/exit_code.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace gridspace::agents {
namespace {

/// What the signal handler has to know; it may neither allocate nor lock.
struct LastWords {
    std::atomic<char const*> function{nullptr}; ///< nullptr: not within a call
    std::atomic<std::int64_t> time_ms{-1};
    std::array<char, 256> fmu{};
    std::atomic<int> status_fd{-1};
};
LastWords last_words; // NOLINT: a handler of signals has no other way to know

/// A text of bounded length, made without the heap.
struct Line {
    std::array<char, 1024> text{};
    std::size_t size{0};
    void add(char const* part) {
        for (; *part != '\0' && size < text.size(); ++part) {
            text[size++] = *part;
        }
    }
    void add(std::int64_t number) {
        std::array<char, 24> digits{};
        std::size_t at = digits.size() - 1;
        do {
            digits[--at] = static_cast<char>('0' + number % 10);
            number /= 10;
        } while (number > 0);
        add(digits.data() + at);
    }
    void write_to(int fd) const {
        for (std::size_t done = 0; done < size;) {
            ssize_t const count = ::write(fd, text.data() + done, size - done);
            if (count <= 0) {
                return;
            }
            done += static_cast<std::size_t>(count);
        }
    }
};

void say_what_happened(Line& line, char const* what) {
    line.add(last_words.fmu.data());
    line.add(": ");
    char const* const function = last_words.function;
    line.add(function == nullptr ? "a call" : function);
    line.add(" ");
    line.add(what);
    if (std::int64_t const ms = last_words.time_ms; ms >= 0) {
        line.add(", at ");
        line.add(ms / 1000);
        std::int64_t const rest = ms % 1000;
        line.add(rest < 10 ? ".00" : rest < 100 ? ".0" : ".");
        line.add(rest);
        line.add(" s of simulated time");
    }
}

/// The end of the process. Only what a signal handler may call.
[[noreturn]] void end_with(char const* what) {
    Line log, status;
    log.add("error: ");
    say_what_happened(log, what);
    log.add("\n");
    log.write_to(STDERR_FILENO);
    if (int const fd = last_words.status_fd; fd >= 0) {
        status.add(R"({"status":"failed","code":4,"message":")"); // no text in it needs to be escaped
        say_what_happened(status, what);
        status.add("\",\"remedy\":\"the fault is in the FMU: tell whoever made it\"}\n");
        status.write_to(fd);
    }
    ::_exit(static_cast<int>(ExitCode::child_died));
}

struct Fault {
    int signal;
    char const* what;
};
constexpr std::array<Fault, 6> kFaults{{{SIGSEGV, "crashed (SIGSEGV, a forbidden address or no stack left)"},
                                        {SIGBUS, "crashed (SIGBUS, a forbidden address)"},
                                        {SIGFPE, "crashed (SIGFPE, a division by zero)"},
                                        {SIGILL, "crashed (SIGILL, no instruction of this processor)"},
                                        {SIGABRT, "aborted (SIGABRT)"},
                                        {SIGSYS, "made a forbidden system call (SIGSYS)"}}};

void handle(int signal) {
    if (last_words.function.load() == nullptr) { // our own fault
        (void)std::signal(signal, SIG_DFL);
        (void)std::raise(signal);
        return;
    }
    auto const* const fault =
        std::find_if(kFaults.begin(), kFaults.end(), [&](Fault const& f) { return f.signal == signal; });
    end_with(fault == kFaults.end() ? "crashed" : fault->what);
}

void handle_exit() {
    if (last_words.function.load() != nullptr) {
        end_with("ended the process");
    }
}

/// Handlers run on a stack of their own: that of the FMU may be used up.
void install_handlers() {
    static std::array<char, 65536> stack;
    stack_t other{};
    other.ss_sp = stack.data();
    other.ss_size = stack.size();
    (void)::sigaltstack(&other, nullptr);
    for (Fault const& fault : kFaults) {
        struct sigaction action{};
        action.sa_handler = handle;
        action.sa_flags = SA_ONSTACK | SA_NODEFER;
        (void)::sigaction(fault.signal, &action, nullptr);
    }
    (void)std::atexit(handle_exit);
}

} // namespace

CallGuard::CallGuard(std::string const& fmu, int status_fd) : fmu_{printable(fmu)} {
    std::replace_if(fmu_.begin(), fmu_.end(), [](char c) { return c == '"' || c == '\\'; }, '?');
    std::size_t const size = std::min(fmu_.size(), last_words.fmu.size() - 1);
    std::memcpy(last_words.fmu.data(), fmu_.data(), size);
    last_words.fmu[size] = '\0';
    last_words.status_fd = status_fd;
    install_handlers();
    watcher_ = std::jthread{[this](std::stop_token const& stop) { watch(stop); }};
}

CallGuard::~CallGuard() {
    last_words.function = nullptr;
}

void CallGuard::now(double seconds) {
    last_words.time_ms = std::llround(seconds * 1e3);
}

void CallGuard::enter(char const* function) noexcept {
    last_words.function = function;
    ++calls_;
}

void CallGuard::leave() noexcept {
    ++calls_;
    last_words.function = nullptr;
}

void CallGuard::say(fmi::Status status, std::string_view category, std::string_view message) noexcept {
    constexpr std::uint64_t kMost = 1000;
    char const* const within = last_words.function.exchange(nullptr); // what fails here is not the FMU's
    try {
        if (++messages_ == kMost) {
            log::warning("{} has logged {} messages: more of them are not shown", fmu_, kMost);
        } else if (messages_ < kMost) {
            log::write(status == fmi::Status::ok        ? log::Level::info
                       : status == fmi::Status::warning ? log::Level::warning
                                                        : log::Level::error,
                       printable(fmt::format("{}{}{}: {}", fmu_, category.empty() ? "" : ", ", category, message)));
        }
    } catch (...) { // a message that finds no memory is not said
        messages_ = messages_ + 0;
    }
    last_words.function = within;
}

/// A process that was stopped meanwhile has not waited: only waits of ours count, and a call is given up after several.
void CallGuard::watch(std::stop_token const& stop) {
    constexpr int kParts = 10;
    std::uint64_t seen = 0;
    int waited = 0;
    while (!stop.stop_requested()) {
        std::int64_t const patience_ms = patience_ms_;
        std::int64_t const part_ms = std::clamp<std::int64_t>(patience_ms / kParts, 10, 1000);
        std::unique_lock lock{mutex_};
        asked_to_stop_.wait_for(lock, stop, std::chrono::milliseconds{part_ms}, [] { return false; });
        std::uint64_t const calls = calls_;
        waited = calls % 2 == 1 && calls == seen ? waited + 1 : 0;
        seen = calls;
        if (patience_ms > 0 && waited * part_ms >= patience_ms) {
            end_with(
                "did not come back in time (half of clock.member_timeout_s, or of start_timeout_s before the start)");
        }
    }
}

} // namespace gridspace::agents
