// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/live.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fmt/format.h>

namespace gridspace::wire {
namespace {

std::atomic<bool> g_stop{false};

std::int64_t read_clock(clockid_t clock) {
    timespec t{};
    ::clock_gettime(clock, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

} // namespace

std::int64_t monotonic_ns() {
    return read_clock(CLOCK_MONOTONIC);
}
std::int64_t utc_ns() {
    return read_clock(CLOCK_REALTIME);
}

void sleep_until(std::int64_t at_ns) {
    constexpr std::int64_t kLookUpNs = 100'000'000; // a signal just before the call would otherwise be slept over
    for (std::int64_t now = monotonic_ns(); now < at_ns && !stopped(); now = monotonic_ns()) {
        std::int64_t const until = std::min(at_ns, now + kLookUpNs);
        timespec const at{until / 1'000'000'000, until % 1'000'000'000};
        ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
    }
}

void catch_signals() {
    struct sigaction action{};
    action.sa_handler = [](int) { g_stop.store(true); };
    ::sigaction(SIGINT, &action, nullptr); // no SA_RESTART: a wait shall end
    ::sigaction(SIGTERM, &action, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
}

bool stopped() {
    return g_stop.load();
}

Result<Sending> open_sending(std::string const& interface, StreamArgument const& stream, streams::Kind kind,
                             std::string const& source) {
    auto described = read_stream(stream, kind);
    if (!described) {
        return fail(ExitCode::usage, "the stream cannot be published");
    }
    auto port = ethernet::Port::open({.interface = interface, .filter = {}, .receive = false});
    if (!port) {
        return std::unexpected{port.error()};
    }
    auto const address = source.empty() ? std::optional{port->mac()} : iec61850::Mac::parse(source);
    if (!address) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an Ethernet address", source));
    }
    return Sending{std::move(*described), std::move(*port), *address};
}

std::string why_not_sent(ethernet::Port& port) {
    auto const& c = port.counters();
    if (c.send_failed == 0) {
        return {};
    }
    return fmt::format("{}{}", std::strerror(c.send_error),
                       c.send_error == EMSGSIZE  ? " (longer than the MTU of the interface: ip link set ... mtu ...)"
                       : c.send_error == ENOBUFS ? " (its queue is full: send slower)"
                                                 : "");
}

void say_not_sent(ethernet::Port& port) {
    if (std::string const why = why_not_sent(port); !why.empty()) {
        fmt::print(stderr, "note: {} frame{} not sent on '{}'; the first: {}\n", port.counters().send_failed,
                   port.counters().send_failed == 1 ? " was" : "s were", port.interface(), why);
    }
}

Result<void> check_sent(ethernet::Port& port) {
    if (port.counters().sent == 0 && port.counters().send_failed > 0) {
        return fail(ExitCode::environment, fmt::format("no frame was sent on '{}'", port.interface()),
                    why_not_sent(port));
    }
    say_not_sent(port);
    return {};
}

std::string time_quality_text(iec61850::UtcTime const& time) {
    using iec61850::UtcTime;
    unsigned const accuracy = time.quality & UtcTime::kAccuracyUnspecified;
    return fmt::format("{}{}{}{}", (time.quality & UtcTime::kLeapSecondsKnown) != 0 ? "leap seconds known, " : "",
                       (time.quality & UtcTime::kClockFailure) != 0 ? "clock failure, " : "",
                       (time.quality & UtcTime::kNotSynchronised) != 0 ? "not synchronised, " : "synchronised, ",
                       accuracy == UtcTime::kAccuracyUnspecified ? "accuracy unspecified"
                                                                 : fmt::format("{} bits", accuracy));
}

} // namespace gridspace::wire
