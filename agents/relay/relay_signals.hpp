// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/current_inputs.hpp"
#include "agents/relay/differential_element.hpp"
#include "agents/relay/relay_program.hpp"
#include "agents/relay/sample_time.hpp"
#include "agents/relay/trip_publisher.hpp"
#include "bus/signal_publisher.hpp"
#include "gateways/port/statistics.hpp"

#include <array>
#include <memory>
#include <vector>

namespace gridspace::relay {

/// What a relay shows of itself: its state, what it counts of its streams, and in real time how old samples are.
class RelaySignals {
  public:
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<RelaySignals>> create(bus::Node& node, RelayConfig const& config,
                                                                      double rate_hz);
    [[nodiscard]] std::size_t streams() const { return streams_; } ///< of sampled values: 1 or 2

    void announce(SimTime now);
    /// `sample_s`: simulated time of the sample that it comes from.
    void state(SimTime now, bool pickup, bool trip, bool blocked, double sample_s);
    /// Real time: how old a sample is when it comes, of end 0 or 1, and when it has been decided about.
    void arrived(std::size_t end, std::int64_t index, std::int64_t unix_ns, SampleTime const& time);
    void decided(std::int64_t index, std::int64_t unix_ns, SampleTime const& time);
    /// What the differential element found at a sample, where its settings ask for that.
    void element(std::int64_t index, ElementValues const& values, SampleTime const& time);

    /// Is it time for the counters again? Once a simulated second, and at the end.
    [[nodiscard]] bool due(SimTime now, bool final);
    void report_statistics(SimTime now, CurrentInputs const& inputs, TripPublisher const& trip,
                           gateways::WirePort& port);
    /// Returns false for the first time in real time: a rate needs two looks.
    bool report_counters(SimTime now, bool final, CurrentInputs const& inputs);
    void flush();

  private:
    RelaySignals(bus::Node& node) : node_{node}, clock_{node} {}
    Result<void> open_ages(RelayConfig const& config, double rate_hz);
    Result<void> open_element(double rate_hz);
    [[nodiscard]] SimTime instant(std::int64_t index, SampleTime const& time) const;
    void publish_age(bus::SignalPublisher* ages, std::int64_t index, std::int64_t unix_ns, SampleTime const& time);
    [[nodiscard]] std::vector<bus::SignalPublisher*> all() const;

    bus::Node& node_;
    gateways::WireClock clock_;
    std::size_t streams_{2};
    std::unique_ptr<bus::SignalPublisher> state_, counters_;
    std::array<std::unique_ptr<bus::SignalPublisher>, 2> arrival_ages_; ///< real time
    std::unique_ptr<bus::SignalPublisher> decision_ages_;               ///< real time
    std::unique_ptr<bus::SignalPublisher> element_;                     ///< where it is asked for
    std::unique_ptr<gateways::StatisticsPublisher> statistics_;
    std::vector<StreamStatistics*> rows_; ///< the inputs, the trip
    std::int64_t reported_{-1}, reported_wall_ns_{0};
    std::array<std::uint64_t, 2> reported_samples_{};
};

} // namespace gridspace::relay
