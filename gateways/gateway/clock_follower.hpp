// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "gateways/ptp/ptp_client.hpp"
#include "gateways/ptp/ptp_config.hpp"
#include "gateways/ptp/time_quality.hpp"

#include <atomic>
#include <memory>

namespace gridspace::gateways {

/// Real time: keeps asking the PTP daemon of this machine how good its clock is, for the samples that are sent. A
/// change is an event of the run and a row of its signals.
class ClockFollower {
  public:
    /// Before Node::start; the signals are clock.<process>.smp_synch and .offset_us.
    [[nodiscard]] static Result<std::unique_ptr<ClockFollower>> create(bus::Node& node, DaemonRun& run,
                                                                       ptp::PtpConfig const& config);
    void announce(SimTime now) { signals_->announce(now); }
    /// On the process's own thread, again and again; `now_ns` of a clock that does not jump.
    void work(std::int64_t now_ns, SimTime time);
    /// When it wants to be called next, on the axis of `now_ns`.
    [[nodiscard]] std::int64_t deadline() const { return asks_at_ns_; }

    /// From any thread.
    [[nodiscard]] std::uint8_t smp_synch() const { return smp_synch_.load(std::memory_order_relaxed); }

  private:
    ClockFollower(bus::Node& node, DaemonRun& run, ptp::PtpClient client, ptp::TimeQuality::Params const& params)
        : node_{node}, run_{run}, client_{std::move(client)}, quality_{params} {}

    bus::Node& node_;
    DaemonRun& run_;
    ptp::PtpClient client_;
    ptp::TimeQuality quality_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::int64_t asks_at_ns_{0};
    std::atomic<std::uint8_t> smp_synch_{0};
};

} // namespace gridspace::gateways
