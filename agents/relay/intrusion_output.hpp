// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/relay_program.hpp"
#include "agents/relay/verdict_publisher.hpp"
#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "common/duration_histogram.hpp"
#include "ids/detector/line_detector.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace gridspace::relay {

/// Makes the state of a relay's detector visible: verdicts on DDS, signals, alarms as events and in the log, and how
/// long a sample takes. Nothing that it says is of the wall clock, except the times, which go into a file beside the
/// recording.
class IntrusionOutput {
  public:
    [[nodiscard]] static Result<std::unique_ptr<IntrusionOutput>> create(bus::Node& node, DaemonRun& run,
                                                                         RelayConfig const& config, Rational rate_hz);

    void announce(SimTime now);
    /// After each judged pair. `index`: absolute; `sample_ns`: simulated time of the sample.
    void sample(ids::LineDetector const& detector, std::int64_t index, std::int64_t sample_ns, SimTime now,
                std::int64_t took_ns);
    /// Counters; once a simulated second and at the end.
    void report(ids::LineDetector const& detector, SimTime now);
    void flush(SimTime now, bool final);

  private:
    IntrusionOutput(bus::Node& node, DaemonRun& run) : node_{node}, run_{run} {}
    void publish_state(ids::LineDetector const& detector, SimTime now);
    void tell(ids::LineDetector const& detector, SimTime now);
    void write_times() const;

    bus::Node& node_;
    DaemonRun& run_;
    std::unique_ptr<bus::Writer<IdsVerdict>> writer_;
    std::vector<VerdictPublisher> verdicts_; ///< from, to; none without a topic
    std::unique_ptr<bus::SignalPublisher> state_, counters_;
    DurationHistogram times_;
    std::optional<ids::Alarms> alarms_;
    std::array<bool, 2> locked_out_{};
    bool granted_{true}, any_told_{false};
};

} // namespace gridspace::relay
