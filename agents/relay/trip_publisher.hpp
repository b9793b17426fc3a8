// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/signal_publisher.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"

#include <deque>
#include <memory>
#include <optional>

namespace gridspace::relay {

/// The relay's GOOSE stream: what the decision was, a latency later, and its repetitions. Every message is also a row
/// of the signals stream.<name>.st_num, .sq_num, .interval_ms and .sent_after_ms (since simulated time 0; in real time
/// by the wall clock).
class TripPublisher {
  public:
    [[nodiscard]] static Result<std::unique_ptr<TripPublisher>>
    create(bus::Node& node, gateways::WirePort& port, streams::Stream const& stream, std::string const& field);

    void announce(SimTime now);
    /// At `now_ns` the state of the trip becomes this.
    void set(bool trip, std::int64_t at_ns);
    /// When something has to be sent; nothing before start().
    [[nodiscard]] std::optional<std::int64_t> due() const;
    /// Does the earliest thing that is due; due() must have a value.
    void work(std::int64_t now_ns);
    void start(std::int64_t now_ns);

    [[nodiscard]] std::uint64_t sent() const { return sent_; }
    [[nodiscard]] iec61850::GoosePublisher::Counters const& counters() const { return publisher_->counters(); }

  private:
    struct Change {
        std::int64_t at_ns;
        bool trip;
    };
    TripPublisher(bus::Node& node, gateways::WirePort& port) : port_{port}, clock_{node} {}
    void stamp();

    gateways::WirePort& port_;
    gateways::WireClock clock_;
    std::unique_ptr<iec61850::GoosePublisher> publisher_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::size_t leaf_{0};
    std::optional<std::size_t> time_leaf_;
    std::deque<Change> changes_; ///< decided, not yet effective; a handful at most
    std::optional<std::int64_t> last_sent_ns_;
    std::uint64_t sent_{0};
};

} // namespace gridspace::relay
