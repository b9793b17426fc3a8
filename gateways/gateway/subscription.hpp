// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/signal_publisher.hpp"
#include "gateways/gateway/context.hpp"
#include "gateways/gateway/subscription_config.hpp"
#include "gateways/iec61850/subscription_supervision.hpp"

#include <memory>
#include <variant>

struct StreamStatistics;

namespace gridspace::gateways {

/// A stream that is subscribed to and supervised; what is known of it are signals: the state of LGOS or LSVS, and the
/// members that are watched. A row when one of them changes.
class Subscription {
  public:
    /// Before Node::start. The configuration was checked; it and the streams must outlive the subscription. `speed`: of
    /// the simulation clock in real time.
    [[nodiscard]] static Result<std::unique_ptr<Subscription>> create(bus::Node& node, WireClock const& clock,
                                                                      SubscriptionConfig const& config,
                                                                      streams::Stream const& stream, double speed,
                                                                      std::size_t number);

    [[nodiscard]] streams::Stream const& stream() const { return stream_; }
    /// After Node::start: publishes the columns, and that nothing has come.
    void announce(SimTime now);
    void receive(Moment at, iec61850::SvFrame const& frame);
    void receive(Moment at, iec61850::GooseFrame const& message);
    /// When the stream counts as lost unless something comes; and: that moment has come.
    [[nodiscard]] std::optional<std::int64_t> deadline() const;
    void expire(Moment at);
    void report(StreamStatistics& out) const;

  private:
    Subscription(WireClock const& clock, SubscriptionConfig const& config, streams::Stream const& stream, double speed);
    void publish(SimTime time);
    [[nodiscard]] iec61850::SupervisionState const& state() const;

    WireClock const& clock_;
    streams::Stream const& stream_;
    std::variant<iec61850::GooseSupervision, iec61850::SvSupervision> supervision_;
    std::vector<std::size_t> watched_; ///< leaves
    iec61850::SvLayout layout_;
    std::vector<std::uint8_t> sample_; ///< the last one, where some of it is watched
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> row_, last_;
};

} // namespace gridspace::gateways
