// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/spsc_ring.hpp"
#include "common/triple_buffer.hpp"
#include "gateways/gateway/scheduled_sender.hpp"
#include "gateways/gateway/sink.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/port/frame_sender.hpp"

#include <atomic>

namespace gridspace::gateways {

/// A stream of sampled values that a gateway sends.
class SampleSink : public Sink {
  public:
    /// When a frame was handed to the kernel, in real time: the index of its last sample, and UTC.
    struct Departure {
        std::int64_t index{0}, unix_ns{0};
    };

    [[nodiscard]] streams::Stream const& stream() const { return *route_.to_stream; }
    [[nodiscard]] std::uint64_t sent() const { return sent_.load(std::memory_order_relaxed); }
    [[nodiscard]] virtual std::uint64_t late() const { return 0; }
    [[nodiscard]] virtual std::uint64_t underruns() const { return 0; }
    bool pop_departure(Departure& out) { return departures_.pop(out); }
    void report(StreamStatistics& out) override;

  protected:
    SampleSink(GatewayContext const& context, Route& route, iec61850::SvTemplate frame);

    /// The mapped values, in the form of the wire.
    void encode(std::span<std::uint8_t> sample) const;
    /// Puts sample `index` into its frame; the frame when that is complete.
    [[nodiscard]] iec61850::Octets fill(std::int64_t index, std::span<std::uint8_t const> sample);
    /// When a sample was taken: simulated UTC; in real time the clock of the machine.
    [[nodiscard]] virtual std::int64_t taken_unix_ns(std::int64_t index);
    /// A frame with `index` as its last sample leaves, or has left.
    void departs(std::int64_t index);
    /// The instant of a sample, as the first one of the time grid that is not before it.
    [[nodiscard]] SimTime instant(std::int64_t index) const;
    /// Lockstep: it belongs to a tick that is over, in which this process was paused. Nobody sends it later.
    [[nodiscard]] bool is_over(std::int64_t index) const;

    GatewayContext const& context_;
    Route& route_;
    iec61850::SvLayout layout_;
    iec61850::SvPublisher publisher_;
    Rational period_quanta_;
    iec61850::SampleGrid grid_;

  private:
    void obey_clock_changes(std::int64_t index);
    void follow_clock();
    std::size_t next_clock_change_{0}; ///< on the thread that sends
    std::int64_t shift_samples_{0};
    bool clock_is_lost_{false}; ///< by an event of the timeline
    std::uint8_t synch_;
    std::optional<std::int64_t> zero_unix_ns_; ///< real time: at simulated time 0, once known; on the thread that sends
    std::atomic<std::uint64_t> sent_{0}, incomplete_{0};
    SpscRing<Departure> departures_{8192};
};

/// Samples that come with their index: each is sent, in its frame.
class IndexedSink final : public SampleSink {
  public:
    [[nodiscard]] static Result<std::unique_ptr<IndexedSink>> create(GatewayContext const& context, Route& route);
    void put(Moment at, std::int64_t index) override;
    [[nodiscard]] std::uint64_t late() const override { return sender_ ? sender_->counters().late : 0; }
    [[nodiscard]] std::uint64_t underruns() const override {
        return missed_ + (sender_ ? sender_->counters().underruns : 0);
    }

  private:
    using SampleSink::SampleSink;
    [[nodiscard]] std::int64_t taken_unix_ns(std::int64_t index) override;
    std::vector<std::uint8_t> sample_;
    bool zero_is_known_{false};
    std::uint64_t missed_{0};             ///< of an index below 0; lockstep: of ticks in which this process was paused
    std::unique_ptr<FrameSender> frames_; ///< of the sender's thread
    std::unique_ptr<ScheduledSender> sender_; ///< real time, scheduled; last: its thread uses what stands above
};

/// The newest values, sampled at the stream's own rate.
class ZeroOrderHoldSink final : public SampleSink {
  public:
    [[nodiscard]] static Result<std::unique_ptr<ZeroOrderHoldSink>> create(GatewayContext const& context, Route& route);
    void start(Moment at) override;
    void put(Moment at, std::int64_t index) override;
    [[nodiscard]] std::optional<std::int64_t> due() const override; ///< lockstep
    void work(std::int64_t now_ns) override;                        ///< lockstep

    // Real time, on the pacer's thread:
    [[nodiscard]] bool has_values() const { return has_values_.load(std::memory_order_acquire); }
    /// Sample `index` now; its frame when that is complete.
    [[nodiscard]] iec61850::Octets sample_now(std::int64_t index);
    void count_late(std::uint64_t wakeups) { late_.store(wakeups, std::memory_order_relaxed); }
    [[nodiscard]] std::int64_t samples_per_frame() const {
        return static_cast<std::int64_t>(publisher_.samples_per_frame());
    }
    [[nodiscard]] std::uint64_t late() const override { return late_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t underruns() const override { return missed_; }

  private:
    ZeroOrderHoldSink(GatewayContext const& context, Route& route, iec61850::SvTemplate frame);
    void begin(Moment at);
    void skip_what_is_over();

    std::vector<std::uint8_t> current_;
    TripleBuffer<std::vector<std::uint8_t>> newest_;
    std::optional<std::int64_t> next_; ///< lockstep: index of the next sample
    std::uint64_t missed_{0};          ///< lockstep: of ticks in which this process was paused
    std::atomic<bool> has_values_{false};
    std::atomic<std::uint64_t> late_{0};
};

} // namespace gridspace::gateways
