// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Which thread of a box runs next, and when time goes on.
#include "timebox/box_impl.hpp"

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <fmt/format.h>
#include <utility>

namespace gridspace::timebox {
namespace {

/// Looks at the clock of one turn, until others come first: who waits by looking must not keep them from going on.
constexpr std::uint64_t kLooksOfATurn = 100;

std::optional<std::int64_t> earlier(std::optional<std::int64_t> a, std::optional<std::int64_t> b) {
    return a && b ? std::min(a, b) : a ? a : b;
}

} // namespace

std::optional<std::int64_t> Box::Impl::next_ns() {
    if (!main_alive) {
        return table.ip() != nullptr ? std::optional{table.ip()->next_ns()} : std::nullopt;
    }
    std::optional<std::int64_t> out = table.timers().next_ns();
    if (table.packets() != nullptr) {
        out = earlier(out, table.packets()->next_ns());
    }
    if (table.ip() != nullptr) {
        out = earlier(out, table.ip()->next_ns());
    }
    if (channel) {
        out = earlier(out, channel->next_ns(table.clock().now_ns()));
    }
    for (Thread const& t : threads) {
        out = earlier(out, t.state != State::held ? table.clock().now_ns() : t.deadline_ns);
    }
    return out;
}

/// In turn, beginning behind the one that ran last.
template <class Fits>
Thread* Box::Impl::first(Fits&& fits) {
    Thread* before = nullptr;
    for (Thread& t : threads) {
        if (fits(t)) {
            if (t.number > last) {
                return &t;
            }
            before = before == nullptr ? &t : before;
        }
    }
    return before;
}

Thread* Box::Impl::first_ready() {
    auto const may_go = [&](Thread const& x) { return x.state == State::held && table.may_go(x); };
    if (Thread* const t = first([&](Thread const& x) { return x.state == State::standing || may_go(x); })) {
        return t;
    }
    if (Thread* const t =
            first([&](Thread const& x) { return x.state == State::held && table.descriptors_ready(x); })) {
        return t;
    }
    table.futexes().wake_changed(
        [&](Futexes::Place const& place) { return value_at<std::uint32_t>(place.process, place.address); });
    return first(may_go);
}

void Box::Impl::exchange() {
    std::int64_t const now_ns = table.clock().now_ns();
    if (table.packets() != nullptr) {
        table.packets()->deliver(now_ns);
    }
    if (table.ip() != nullptr) {
        table.ip()->bring_up_to(now_ns);
    }
    if (channel) {
        channel->exchange(now_ns);
    }
}

Thread* Box::Impl::choose() {
    SimulatedClock& clock = table.clock();
    while (main_alive && !error && !stop) {
        if (limit_ns && clock.now_ns() > *limit_ns) {
            return nullptr;
        }
        exchange(); // at one instant, what arrives comes before what is due
        table.timers().ring(clock.now_ns(), [&](pid_t process) {
            ::kill(process, SIGALRM);
            table.signalled().insert(process);
        });
        look_for_signals();
        if (std::ranges::any_of(threads, &Thread::dying)) { // before anybody goes on, and before time does
            wait_for_event();
            continue;
        }
        if (Thread* const t = first_ready()) {
            return t;
        }
        if (std::any_of(threads.begin(), threads.end(), [](Thread const& t) { return t.state == State::in_fork; })) {
            wait_for_event();
            continue;
        }
        if (table.ip() != nullptr) {
            table.ip()->end_instant();
            if (Thread* const t = first_ready()) { // on 127.0.0.1 it has an effect at once
                return t;
            }
        }
        auto const next = next_ns();
        bool const alone = options.link.has_value();
        if (limit_ns && (next ? *next > *limit_ns : alone)) {
            clock.elapse_to(*limit_ns);
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

void Box::Impl::run_network() {
    SimulatedClock& clock = table.clock();
    IpSockets* const ip = table.ip();
    if (ip == nullptr || !limit_ns) {
        return;
    }
    ip->bring_up_to(clock.now_ns());
    ip->end_instant();
    for (std::int64_t next = ip->next_ns(); next <= *limit_ns; next = ip->next_ns()) {
        clock.elapse_to(next);
        ip->bring_up_to(clock.now_ns());
        ip->end_instant();
    }
    clock.elapse_to(*limit_ns);
}

void Box::Impl::look_for_signals() {
    if (table.signalled().empty()) {
        return;
    }
    bool const anybody = table.signalled().contains(0);
    if (anybody) {
        look_for_killed(0);
    }
    for (Thread& t : threads) {
        if (t.state == State::held && (anybody || table.signalled().contains(t.process))) {
            t.interrupted = table.has_signal(t);
        }
    }
    table.signalled().clear();
}

/// Nothing in the box will happen by itself: something may come from outside.
bool Box::Impl::wait_outside() {
    constexpr int kLookAgainMs = 100;
    bool anything = false;
    for (Thread const& t : threads) {
        if (t.state == State::held && !t.interests.empty()) {
            anything = true;
            if (table.descriptors(t.process).wait_outside(t.interests, kLookAgainMs)) {
                return true;
            }
        }
    }
    if (!anything) {
        std::string waits;
        for (Thread const& t : threads) {
            waits += fmt::format("{}{} in {}", waits.empty() ? "" : ", ", name_of(t.process),
                                 t.what != nullptr ? t.what->name : "?");
        }
        error = Error{ExitCode::stall,
                      fmt::format("nothing can happen any more at {:.9f} s: {}",
                                  static_cast<double>(table.clock().now_ns()) / 1e9, waits),
                      "they wait for each other"};
    }
    stop = stop || asked_to_stop();
    return anything;
}

bool Box::Impl::others_come_first() {
    std::int64_t const now_ns = table.clock().now_ns();
    auto const timer_ns = table.timers().next_ns();
    return (limit_ns && now_ns > *limit_ns) || (others_due_ns && now_ns >= *others_due_ns) ||
           (timer_ns && now_ns >= *timer_ns) || report.clock_reads - looks_before >= kLooksOfATurn;
}

void Box::Impl::open_clock(pid_t process) {
    if (ClockPage* const page = clock_pages.begin(process)) {
        page->now_ns = table.clock().now_ns();
        page->last_ns = last_look_ns();
        page->looks_left = static_cast<std::int64_t>(kLooksOfATurn - 1) -
                           static_cast<std::int64_t>(report.clock_reads - looks_before); // the last one is a call
        page->looks = {};
    }
}

void Box::Impl::close_clock() {
    if (ClockPage* const page = clock_pages.end()) {
        table.clock().elapse_to(page->now_ns);
        table.count_looks(std::exchange(page->looks, {}));
    }
}

/// To where looks may bring the clock while nothing else happens: a call would only read it.
std::int64_t Box::Impl::last_look_ns() {
    if (table.ip() != nullptr && !channel) {
        return -1; // what has been closed meanwhile is seen at each call, and by others at that time
    }
    std::int64_t const now_ns = table.clock().now_ns();
    auto next = earlier(others_due_ns, table.timers().next_ns());
    next = table.packets() != nullptr ? earlier(next, table.packets()->next_ns()) : next;
    next = table.ip() != nullptr ? earlier(next, table.ip()->next_ns()) : next;
    next = channel ? earlier(next, channel->next_ns(now_ns)) : next;
    std::int64_t const limit = limit_ns.value_or(INT64_MAX);
    return next ? std::min(limit, *next - 1) : limit;
}

/// Until it waits, or is gone.
void Box::Impl::let_go(Thread& t) {
    last = t.number;
    looks_before = report.clock_reads;
    others_due_ns.reset();
    for (Thread const& other : threads) {
        if (&other != &t && other.state == State::held) {
            others_due_ns = earlier(others_due_ns, other.deadline_ns);
        }
    }
    Next how = Next::go;
    if (t.state == State::held) {
        if (options.on_held && !t.made_again) {
            options.on_held(static_cast<double>(table.clock().now_ns()) / 1e9, t.number, t.what->name,
                            static_cast<double>(table.clock().now_ns() - t.since_ns) / 1e9);
        }
        how = table.release(t);
        if (how == Next::hold) { // a part of what it waits for
            return;
        }
        if (how == Next::answered && others_come_first()) {
            t.state = State::standing;
            return;
        }
    }
    resume(t, how);
    while (running != 0 && !error && !stop) {
        wait_for_event();
    }
}

} // namespace gridspace::timebox
