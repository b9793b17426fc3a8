// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/spsc_ring.hpp"
#include "gateways/gateway/playout.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <thread>
#include <vector>

namespace gridspace::gateways {

/// Sends samples at their exact rate, like a device with a clock of its own: each `buffer_s` after the instant at which
/// it was taken, by absolute deadlines (Playout). A sample that is not here when it is due is waited for (an
/// underrun); what is owed then is caught up at no more than twice the rate. The counter of a sample never skips or
/// repeats.
class ScheduledSender {
  public:
    struct Params {
        double rate_hz{4800};
        double buffer_s{0.0015};
        std::size_t sample_octets{0};
        bool expects_zero{false}; ///< somebody will say when simulated time was 0
    };
    struct Counters {
        std::uint64_t late{0};      ///< wake-ups that found more than one sample due
        std::uint64_t underruns{0}; ///< a due sample was not here yet
        std::uint64_t overflows{0}; ///< samples refused because the buffer was full
    };
    using Send = std::function<void(std::int64_t index, std::span<std::uint8_t const> sample)>;

    /// `send` is called on the sender's thread, `idle` there every few hundred milliseconds.
    ScheduledSender(Params params, Send send, std::function<void()> idle);
    ~ScheduledSender();
    ScheduledSender(ScheduledSender const&) = delete;
    ScheduledSender& operator=(ScheduledSender const&) = delete;

    /// From one other thread; `sample` has the length of Params. Neither waits nor allocates.
    void push(std::int64_t index, std::span<std::uint8_t const> sample);
    /// When simulated time was 0, on the monotonic clock. From any thread; before the first sample is sent it counts.
    void set_zero(std::int64_t zero_ns);
    [[nodiscard]] Counters counters() const;

  private:
    void loop();
    [[nodiscard]] bool await_first(Playout& playout, std::function<void(std::int64_t)> const& look_after);
    static constexpr std::size_t kCapacity = 4096;       // 0.85 s at 4800 Hz
    static constexpr std::size_t kSlots = kCapacity + 2; // what is being sent is not overwritten

    Params params_;
    Send send_;
    std::function<void()> idle_;
    std::vector<std::uint8_t> slots_;
    SpscRing<std::int64_t> ring_{kCapacity};
    std::uint64_t pushed_{0}, popped_{0}; ///< of one thread each
    std::atomic<std::uint64_t> late_{0}, underruns_{0}, overflows_{0};
    std::atomic<std::int64_t> zero_ns_{0}; ///< 0: not known
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

} // namespace gridspace::gateways
