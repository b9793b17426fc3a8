// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/scheduled_sender.hpp"

#include "common/sleep_until.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace gridspace::gateways {
namespace {

std::int64_t now_ns() {
    return std::chrono::steady_clock::now().time_since_epoch().count();
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

void ScheduledSender::set_zero(std::int64_t zero_ns) {
    zero_ns_.store(zero_ns, std::memory_order_release);
}

/// Waits for the first sample, and a moment for the clock that may come behind it.
bool ScheduledSender::await_first(Playout& playout, std::function<void(std::int64_t)> const& look_after) {
    constexpr std::int64_t kIdleNs = 200'000, kPatienceNs = 25'000'000; // the clock is published every 10 ms
    std::int64_t arrived = 0;
    while (!stop_) {
        std::int64_t const now = now_ns();
        std::int64_t const* const first = ring_.front();
        arrived = first != nullptr && arrived == 0 ? now : arrived;
        std::int64_t const zero = zero_ns_.load(std::memory_order_acquire);
        bool const waits = params_.expects_zero && zero == 0 && now - arrived < kPatienceNs;
        if (first != nullptr && !waits) {
            playout.begin(*first, arrived, zero != 0 ? std::optional{zero} : std::nullopt);
            return true;
        }
        sleep_until(now + kIdleNs);
        look_after(now);
    }
    return false;
}

void ScheduledSender::loop() {
    constexpr std::int64_t kLookAfterNs = 200'000'000;
    std::int64_t looked = now_ns();
    auto const look_after = [&](std::int64_t now) {
        if (now - looked > kLookAfterNs) {
            looked = now;
            idle_();
        }
    };
    Playout playout{params_.rate_hz, params_.buffer_s};
    if (!await_first(playout, look_after)) {
        return;
    }
    std::int64_t next = *ring_.front(); // the index of the next sample, as far as none is missing
    std::int64_t slot = std::max(next, playout.index_at(now_ns()));
    bool starving = false;
    for (; !stop_; ++slot) {
        sleep_until(playout.due(slot));
        std::int64_t const now = now_ns();
        slot = std::max(slot, playout.index_at(now)); // slept through whole periods: their samples are owed
        std::int64_t const owed = slot + 1 - next;
        late_ += owed > 1 ? 1 : 0;
        for (std::int64_t n = std::min<std::int64_t>(owed, 2); n > 0; --n) {
            std::int64_t const* const index = ring_.front();
            if (index == nullptr) {
                underruns_ += starving ? 0 : 1;
                starving = true;
                break;
            }
            if (*index > slot) {
                break; // samples are missing before it
            }
            if (starving) {
                playout.came_late(now - playout.due(*index));
                starving = false;
            }
            std::size_t const at = popped_++ % kSlots * params_.sample_octets;
            next = *index + 1;
            send_(*index, std::span{slots_}.subspan(at, params_.sample_octets));
            ring_.drop();
        }
        if (playout.slot()) {
            slot = playout.index_at(now);
        }
        look_after(now);
    }
}

} // namespace gridspace::gateways
