// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/signal_publisher.hpp"
#include "gateways/first_line/first_line.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// The counters of a process's first lines as signals, first_line.PROCESS.STREAM.suspicious and .refused.
class FirstLineSignals {
  public:
    /// Before Node::start.
    [[nodiscard]] static Result<std::unique_ptr<FirstLineSignals>> create(bus::Node& node,
                                                                          std::span<std::string const> streams);

    void announce(SimTime now) { signals_->announce(now); }
    /// In the order of the streams; published when they have changed.
    void publish(SimTime now, std::span<FirstLineCounters const> counters);

  private:
    explicit FirstLineSignals(std::unique_ptr<bus::SignalPublisher> signals) : signals_{std::move(signals)} {}
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> last_;
};

} // namespace gridspace::gateways
