// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/scheduled_sender.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>

namespace gridspace::gateways {
namespace {

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch().count();
}

void sleep_until(std::int64_t ns) {
    timespec const until{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

} // namespace

ScheduledSender::ScheduledSender(Params params, Send send, std::function<void()> idle)
    : params_{params}, send_{std::move(send)}, idle_{std::move(idle)}, slots_(kSlots * params.sample_octets) {
    thread_ = std::thread{[this] { loop(); }};
}

ScheduledSender::~ScheduledSender() {
    stop_ = true;
    thread_.join();
}

void ScheduledSender::push(std::int64_t index, std::span<std::uint8_t const> sample) {
    std::size_t const slot = pushed_ % kSlots * params_.sample_octets;
    std::copy(sample.begin(), sample.end(), slots_.begin() + static_cast<std::ptrdiff_t>(slot));
    if (ring_.push(index)) {
        ++pushed_;
    } else {
        ++overflows_;
    }
}

ScheduledSender::Counters ScheduledSender::counters() const {
    return {late_.load(), underruns_.load(), overflows_.load()};
}

void ScheduledSender::loop() {
    constexpr std::int64_t kIdleNs = 500'000; // before the first sample
    constexpr std::int64_t kLookAfterNs = 200'000'000;
    std::int64_t looked = now_ns();
    auto const look_after = [&](std::int64_t now) {
        if (now - looked > kLookAfterNs) {
            looked = now;
            idle_();
        }
    };
    while (!stop_ && ring_.empty()) {
        sleep_until(now_ns() + kIdleNs);
        look_after(now_ns());
    }
    double const period_ns = 1e9 / params_.rate_hz;
    std::int64_t const start = now_ns() + static_cast<std::int64_t>(params_.buffer_s * 1e9);
    auto const due = [&](std::uint64_t k) { return start + std::llround(static_cast<double>(k) * period_ns); };
    std::uint64_t sent = 0;
    bool starving = false;
    for (std::uint64_t slot = 0; !stop_; ++slot) {
        sleep_until(due(slot));
        std::int64_t const now = now_ns();
        while (due(slot + 1) <= now) { // slept through whole periods: their samples are owed
            ++slot;
        }
        std::uint64_t const owed = slot + 1 - sent;
        late_ += owed > 1 ? 1 : 0;
        for (std::uint64_t n = std::min<std::uint64_t>(owed, 2); n > 0; --n) {
            std::int64_t index = 0;
            if (!ring_.pop(index)) {
                underruns_ += starving ? 0 : 1;
                starving = true;
                break;
            }
            starving = false;
            std::size_t const at = popped_++ % kSlots * params_.sample_octets;
            send_(index, std::span{slots_}.subspan(at, params_.sample_octets));
            ++sent;
        }
        look_after(now);
    }
}

} // namespace gridspace::gateways
