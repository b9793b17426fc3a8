// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/relay_parts.hpp"
#include "agents/relay/relay_program.hpp"
#include "bus/member.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace gridspace::relay {

/// What every relay is on the bus: frames of sampled values in, in the order of their times, GOOSE out. What it decides
/// by them is its own.
class RelayMember : public bus::Member {
  public:
    RelayMember(RelaySettings const& settings, DaemonRun& run, bus::Node& node);

    Result<void> prepare() final;
    void begin(bus::Tick const& tick) final;
    Result<void> work(bus::Tick const& tick) final;
    std::uint64_t next_tick(bus::Tick const& tick) const final;
    std::optional<std::chrono::steady_clock::time_point> deadline() const final;

  protected:
    /// The wire is open; before Node::start.
    virtual Result<void> prepare_relay() { return {}; }
    virtual void announce(SimTime now) = 0;
    virtual void pair(LineSample const& sample) = 0;
    /// Nothing comes of this end any more.
    virtual void silent(std::size_t end) = 0;
    virtual void publish_state() = 0;
    virtual void report_relay(bus::Tick const& /*tick*/) {}

    [[nodiscard]] SimTime now() const { return clock_.sim_time(now_ns_); }
    /// A member of the trip stream changes, a latency from now.
    void send(bool state, std::size_t field = 0);
    /// Into the log, and among the events of the run.
    void tell(std::string_view kind, std::string const& text);

    RelaySettings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    RelayParts parts_;
    std::optional<SampleTime> time_; ///< after prepare()
    gateways::WireClock clock_;

  private:
    [[nodiscard]] std::optional<std::int64_t> next_work() const;
    void elapse(std::int64_t until_ns);
    void work_through(SimTime end);
    void work_now();
    void take_frames();
    [[nodiscard]] std::uint64_t samples_of(std::size_t end) const;
    void report(bus::Tick const& tick);

    bus::TickGrid grid_;
    std::int64_t latency_ns_;
    SimSpan promise_;
    CurrentInputs::OnPair on_pair_{[this](LineSample const& sample) { pair(sample); }};
    std::int64_t now_ns_{0};
};

/// The relay of a bay, `functions:`. Differential relays of a line are made by the program itself.
[[nodiscard]] std::unique_ptr<RelayMember> make_function_relay(RelaySettings const& settings, DaemonRun& run,
                                                               bus::Node& node);

} // namespace gridspace::relay
