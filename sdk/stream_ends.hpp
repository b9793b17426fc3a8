// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/sample_pacer.hpp"
#include "gateways/gateway/source.hpp"
#include "gateways/port/statistics.hpp"
#include "sdk/sample_inbox.hpp"
#include "sdk/stream_type.hpp"

#include <memory>
#include <string>
#include <vector>

namespace gridspace::sdk {

/// The streams of a program: received ones become samples of its readers, what it writes becomes frames. The same
/// sources and sinks as a gateway's, without DDS between them and the program.
class StreamEnds {
  public:
    /// A stream, and the type that it is to the program.
    struct End {
        std::string stream;
        std::shared_ptr<TopicType const> type;
    };
    /// Before Node::start. `first_reader`: the number of the first stream that is read.
    [[nodiscard]] static Result<std::unique_ptr<StreamEnds>>
    open(bus::Node& node, gateways::WireConfig const& wire, SimSpan latency, std::vector<std::string> const& reads,
         std::vector<std::string> const& writes, int first_reader);
    ~StreamEnds();
    StreamEnds(StreamEnds const&) = delete;
    StreamEnds& operator=(StreamEnds const&) = delete;

    [[nodiscard]] std::vector<End> const& reads() const { return reads_; }
    [[nodiscard]] std::vector<End> const& writes() const { return writes_; }

    void begin(bus::Tick const& tick);
    /// What has come up to this tick goes behind `arrivals`, and what has fallen silent.
    void take(bus::Tick const& tick, std::vector<SampleInbox::Arrival>& arrivals);
    /// New values of a stream that is written, a latency after `now`.
    void write(std::size_t stream, std::span<std::byte const> cdr, SimTime now);
    /// Sends what is due before `now`: what is written at `now` comes first.
    void send_before(SimTime now);
    /// The end of a tick: sends what is due, and publishes its statistics.
    void finish(bus::Tick const& tick);
    /// In lockstep, the simulated time at which something is due; and in real time, when.
    [[nodiscard]] std::optional<SimTime> next() const;
    [[nodiscard]] std::chrono::steady_clock::time_point deadline() const;
    void end();

  private:
    StreamEnds(bus::Node& node, gateways::WireConfig const& wire);
    [[nodiscard]] Result<void> open_read(streams::Stream const& stream, int reader);
    [[nodiscard]] Result<void> open_write(streams::Stream const& stream);
    [[nodiscard]] Result<gateways::Route*> add_route(streams::Stream const& stream, StreamType const& type,
                                                     std::vector<End>& ends);
    void follow_start();
    void handle(bus::WireFrame const& frame, std::uint16_t ethertype, gateways::Moment at);
    void expire(std::int64_t until_ns);
    void send(std::int64_t until_ns);
    [[nodiscard]] std::optional<std::int64_t> next_expiry() const;
    [[nodiscard]] std::optional<std::int64_t> next_send() const;

    bus::Node& node_;
    gateways::WireConfig wire_;
    gateways::WireClock clock_;
    std::unique_ptr<gateways::WirePort> port_;
    std::unique_ptr<gateways::GatewayContext> context_;
    std::vector<End> reads_, writes_;
    std::vector<std::unique_ptr<gateways::Route>> routes_;
    std::vector<std::unique_ptr<gateways::Sink>> inward_, outward_;     ///< by reads_, by writes_
    std::vector<std::unique_ptr<gateways::Source>> received_, written_; ///< by reads_, by writes_
    std::vector<std::uint16_t> ethertypes_;                             ///< received
    std::unique_ptr<gateways::StatisticsPublisher> statistics_;
    std::vector<StreamStatistics*> rows_; ///< those of reads_, then those of writes_
    std::vector<SampleInbox::Arrival>* arrivals_{nullptr};
    std::uint64_t arrived_{0};
    struct Due {
        SimTime time;
        bus::WireFrame const* frame;
        std::uint16_t ethertype;
    };
    std::vector<Due> due_; ///< of a tick; reused
    std::unique_ptr<iec61850::SvFrame> sv_{std::make_unique<iec61850::SvFrame>()};
    iec61850::GooseFrame goose_;
    gateways::Moment last_;
    bool ended_{false};
    std::unique_ptr<gateways::SamplePacer> pacer_; ///< last: its thread uses what stands above
    friend class InwardSink;
};

} // namespace gridspace::sdk
