// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "gateways/first_line/first_line.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/streams/stream.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// What the first-line rules of a process have found, as signals (`first_line.PROCESS.alarm`, and counters once a
/// second: `first_line.PROCESS.STREAM.FINDING`), as events, and in the log. What is found about the authenticity of
/// frames is reported with it.
class FirstLineReport {
  public:
    struct Stream {
        std::string name;
        streams::Kind kind{streams::Kind::smv};
        /// Counters by finding; refused; and of sampled values: contested.
        std::function<std::span<std::uint64_t const>()> counters;
        std::function<std::uint64_t()> refused, contested;
    };
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<FirstLineReport>>
    create(bus::Node& node, DaemonRun& run, std::vector<Stream> streams, FrameAuthentication* authentication);

    /// After Node::start.
    void announce(SimTime now);
    /// Suspicious findings in a frame of stream `i`.
    void finding(std::size_t i, std::uint32_t findings, iec61850::Mac const& source, SimTime now);
    /// Once a second, and at the end.
    void report(SimTime now);

  private:
    FirstLineReport(bus::Node& node, DaemonRun& run) : node_{node}, run_{run} {}
    void publish_alarm(SimTime now);
    /// The first place of this stream.
    [[nodiscard]] std::optional<std::size_t> place_of(std::string const& stream) const;
    [[nodiscard]] FrameAuthentication::Counters const* authenticity(std::string const& stream) const {
        return authentication_ == nullptr ? nullptr : authentication_->counters(stream);
    }

    bus::Node& node_;
    DaemonRun& run_;
    std::vector<Stream> streams_;
    FrameAuthentication* authentication_{nullptr};
    std::vector<FirstLineAlarm> alarms_;
    std::unique_ptr<bus::SignalPublisher> state_, counters_;
    std::vector<double> row_;
    bool alarm_{false};
};

} // namespace gridspace::gateways
