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
#include <string>
#include <vector>

namespace gridspace::relay {

/// The relay's GOOSE stream: what the decision was, a latency later, and its repetitions. Every message is also a row
/// of the signals stream.<name>.st_num, .sq_num, .interval_ms and .sent_after_ms (since simulated time 0; in real time
/// by the wall clock).
class TripPublisher {
  public:
    /// `fields`: Boolean members of the data set; the trip comes first.
    [[nodiscard]] static Result<std::unique_ptr<TripPublisher>> create(bus::Node& node, gateways::WirePort& port,
                                                                       streams::Stream const& stream,
                                                                       std::vector<std::string> const& fields);

    void announce(SimTime now);
    /// At `at_ns` the state of a member becomes this. What changes at the same time is one message.
    void set(bool state, std::int64_t at_ns, std::size_t field = 0);
    /// When something has to be sent; nothing before start().
    [[nodiscard]] std::optional<std::int64_t> due() const;
    /// Does the earliest thing that is due; due() must have a value.
    void work(std::int64_t now_ns);
    void start(std::int64_t now_ns);
    /// Lockstep: hands the messages up to `until_ns` to the port before their time, as they will be when it comes:
    /// nothing that is decided later can change them. Counters and signals follow at their time, with work().
    void send_ahead(std::int64_t until_ns);

    [[nodiscard]] std::uint64_t sent() const { return sent_; }
    [[nodiscard]] iec61850::GoosePublisher::Counters const& counters() const { return publisher_->counters(); }

    struct Change {
        std::int64_t at_ns;
        std::size_t field;
        bool state;
    };

  private:
    TripPublisher(bus::Node& node, gateways::WirePort& port) : port_{port}, clock_{node} {}
    /// Does the earliest thing that is due; the message, when that is one.
    [[nodiscard]] iec61850::Octets advance(iec61850::GoosePublisher& publisher, std::deque<Change>& changes,
                                           std::int64_t now_ns) const;
    void stamp(iec61850::GoosePublisher& publisher) const;

    gateways::WirePort& port_;
    gateways::WireClock clock_;
    std::unique_ptr<iec61850::GoosePublisher> publisher_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<std::size_t> leaves_; ///< of the fields
    std::optional<std::size_t> time_leaf_;
    std::deque<Change> changes_;            ///< decided, not yet effective; a handful at most
    std::int64_t sent_ahead_ns_{INT64_MIN}; ///< up to here the messages are at the port
    std::optional<std::int64_t> last_sent_ns_;
    std::uint64_t sent_{0};
};

} // namespace gridspace::relay
