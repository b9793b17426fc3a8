// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/port/wire_port.hpp"

#include <memory>
#include <statistics.h>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// What a device counts of its streams, on the topic stream_statistics: once a second and at the end.
class StatisticsPublisher {
  public:
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<StatisticsPublisher>> create(bus::Node& node);

    /// A row of a stream, to be filled by its owner before each publish(). Stays where it is.
    [[nodiscard]] StreamStatistics& add(std::string const& stream, StreamDirection direction);

    /// Is it time again? At most once a second, and at the end.
    [[nodiscard]] bool due(SimTime now, bool final);
    void publish(SimTime now);

  private:
    explicit StatisticsPublisher(bus::Node& node) : node_{node} {}
    bus::Node& node_;
    std::unique_ptr<bus::Writer<StreamStatistics>> writer_;
    std::vector<std::unique_ptr<StreamStatistics>> rows_;
    std::int64_t last_second_{INT64_MIN};
};

// Counters of the state machines, as a row has them.
void report_received(StreamStatistics& out, iec61850::SvSubscriber const& subscriber);
void report_received(StreamStatistics& out, iec61850::GooseSubscriber const& subscriber);
void report_sent(StreamStatistics& out, iec61850::GoosePublisher::Counters const& counters);

} // namespace gridspace::gateways
