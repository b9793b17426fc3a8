// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/clock_follower.hpp"

#include "gateways/port/declared_signals.hpp"

#include <cmath>

namespace gridspace::gateways {
namespace {

constexpr std::int64_t kAskEveryNs = 250'000'000; ///< and what is answered is heard when it asks next

/// Where answers go to. The daemon reads the name as we wrote it: one that shares our folder may have a relative one,
/// which is short enough whatever the run folder is.
std::filesystem::path own_name(std::string const& process, std::filesystem::path const& daemon) {
    std::filesystem::path const name = process + ".ptp";
    return daemon.is_relative() ? name : std::filesystem::absolute(name);
}

} // namespace

Result<std::unique_ptr<ClockFollower>> ClockFollower::create(bus::Node& node, DaemonRun& run,
                                                             ptp::PtpConfig const& config) {
    std::string const& process = node.config().process;
    auto client =
        ptp::PtpClient::open(config.socket, own_name(process, config.socket), static_cast<std::uint8_t>(config.domain));
    if (!client) {
        return std::unexpected{client.error()};
    }
    ptp::TimeQuality::Params params;
    params.within_ns = std::llround(config.within_us * 1e3);
    params.holdover_ns = std::llround(config.holdover_s * 1e9);
    auto out = std::unique_ptr<ClockFollower>{new ClockFollower{node, run, std::move(*client), params}};
    auto signals = bus::SignalPublisher::create(node, "clock", clock_signals(), {});
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    out->signals_ = std::move(*signals);
    return out;
}

void ClockFollower::work(std::int64_t now_ns, SimTime time) {
    if (now_ns < asks_at_ns_) {
        return; // a merging unit wakes up for every message of the simulator
    }
    asks_at_ns_ = now_ns + kAskEveryNs;
    client_.hear([&](ptp::ManagementResponse const& response) { quality_.hear(response, now_ns); });
    (void)client_.ask(ptp::ManagementId::time_status); // nobody there: it may come
    (void)client_.ask(ptp::ManagementId::parent_data_set);
    bool const changed = quality_.look(now_ns);
    smp_synch_.store(quality_.smp_synch(), std::memory_order_relaxed);
    if (changed) {
        run_.status.event(node_.time_base().seconds(time), node_.config().process, "clock", quality_.text());
    }
    std::array const row{static_cast<double>(quality_.smp_synch()), static_cast<double>(quality_.offset_ns()) / 1e3};
    signals_->row(time, row);
}

} // namespace gridspace::gateways
