// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/sample_sink.hpp"
#include "gateways/port/frame_sender.hpp"

#include <atomic>
#include <thread>
#include <vector>

namespace gridspace::gateways {

/// Sends the held streams of a gateway in real time, each at its own rate and all that are due at a wake-up together:
/// one thread, absolute deadlines, sample n at simulated time n / rate. A late wake-up is counted and caught up; no
/// smpCnt is skipped or repeated.
class SamplePacer {
  public:
    /// `port` and `streams` must outlive it.
    [[nodiscard]] static Result<std::unique_ptr<SamplePacer>> create(WireConfig const& wire, WirePort& port,
                                                                     std::vector<ZeroOrderHoldSink*> streams);
    ~SamplePacer();
    SamplePacer(SamplePacer const&) = delete;
    SamplePacer& operator=(SamplePacer const&) = delete;

    /// `zero_unix_ns`: CLOCK_REALTIME at simulated time 0. Begins to send; further calls do nothing.
    void start(std::int64_t zero_unix_ns);

  private:
    SamplePacer(WireConfig const& wire, std::vector<ZeroOrderHoldSink*> streams, FrameSender sender);
    void loop();

    struct Paced {
        ZeroOrderHoldSink* sink;
        Rational rate_hz; ///< in real time: with the speed of the clock
        std::optional<iec61850::SendSchedule> schedule;
    };
    [[nodiscard]] std::int64_t begin_due(std::int64_t now_ns);

    std::vector<Paced> streams_;
    FrameSender sender_;
    std::int64_t zero_ns_{0}; ///< on the monotonic clock
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

} // namespace gridspace::gateways
