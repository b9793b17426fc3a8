// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
#include "gateways/gateway/sample_pacer.hpp"
#include "gateways/gateway/source.hpp"
#include "gateways/gateway/subscription.hpp"
#include "gateways/port/first_line_report.hpp"
#include "gateways/port/statistics.hpp"

#include <map>
#include <memory>
#include <vector>

namespace gridspace::gateways {

/// What a gateway is, apart from its table: gridspace-gateway itself, or one of its presets.
struct GatewaySettings {
    GatewayConfig gateway;
    WireConfig wire;
};

/// Its signals and its log, where they are other than those of every gateway. All calls on the process's own thread.
class GatewayGuest {
  public:
    virtual ~GatewayGuest() = default;
    /// Before Node::start: opens its signals, looks at the sources.
    [[nodiscard]] virtual Result<void> prepare(bus::Node& node,
                                               std::vector<std::unique_ptr<Source>> const& sources) = 0;
    virtual void announce(SimTime now) = 0;
};

/// Runs the mappings on the bus and on the wire, on either clock. In lockstep everything happens in the order of
/// simulated time and takes effect a latency later, whatever the tick.
class Gateway final : public bus::Member {
  public:
    Gateway(GatewaySettings const& settings, DaemonRun& run, bus::Node& node, GatewayGuest* guest = nullptr);
    ~Gateway() override;

    [[nodiscard]] Result<void> prepare() override;
    void begin(bus::Tick const& tick) override;
    [[nodiscard]] Result<void> work(bus::Tick const& tick) override;
    [[nodiscard]] std::uint64_t next_tick(bus::Tick const& tick) const override;
    [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> deadline() const override;
    void end(bus::Tick const& last) override;

  private:
    struct Topic; ///< one that is read, by all mappings of it
    struct Event;

    [[nodiscard]] Result<void> open_route(Route& route);
    [[nodiscard]] Result<Sink*> open_sink(Route& route);
    [[nodiscard]] Result<bus::CdrWriter*> writer_of(Route const& route);
    [[nodiscard]] Result<void> open_reader(Route const& route, Source& source);
    [[nodiscard]] Result<void> open_pacer(); ///< of held samples; nothing in lockstep
    [[nodiscard]] Result<void> open_signals();
    [[nodiscard]] Result<void> open_first_line();
    [[nodiscard]] Result<void> open_subscriptions();
    void follow_start();
    void finish(Moment at);
    void take_input(bus::Tick const& tick);
    void handle(Event const& event, Moment at);
    void handle(bus::WireFrame const& frame, std::uint16_t ethertype, Moment at);
    /// All deadlines up to this moment, in their order; in lockstep none is met before the present tick.
    void run_timers(std::int64_t until_ns);
    [[nodiscard]] std::optional<std::int64_t> next_timer() const;
    [[nodiscard]] Moment moment_of(bus::Tick const& tick) const;
    [[nodiscard]] std::int64_t begin_ns(bus::Tick const& tick) const;
    void publish_counters(bus::Tick const& tick);
    void publish_ages();

    GatewaySettings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    GatewayGuest* guest_;
    bus::TickGrid grid_;
    WireClock clock_;
    std::unique_ptr<WirePort> port_;
    std::unique_ptr<ClockFollower> follower_; ///< real time, where it is configured
    std::unique_ptr<GatewayContext> context_;
    std::vector<Route> routes_;
    std::map<std::string, std::unique_ptr<bus::CdrWriter>> writers_; ///< by topic
    std::vector<std::unique_ptr<Sink>> sinks_;
    std::vector<std::unique_ptr<Source>> sources_; ///< by mapping
    std::vector<std::unique_ptr<Topic>> topics_;
    std::vector<Event> events_;
    std::vector<std::uint16_t> received_; ///< ethertypes
    std::unique_ptr<iec61850::SvFrame> sv_{std::make_unique<iec61850::SvFrame>()};
    iec61850::GooseFrame goose_;
    std::uint64_t undecodable_{0};

    std::unique_ptr<FirstLineReport> first_line_; ///< of all mappings from streams; may be empty
    std::unique_ptr<StatisticsPublisher> statistics_;
    std::vector<StreamStatistics*> rows_; ///< by mapping, then by subscription
    std::vector<std::unique_ptr<Subscription>> subscriptions_;
    std::unique_ptr<bus::SignalPublisher> counters_;
    struct Watch {
        std::unique_ptr<bus::SignalPublisher> signals;
        std::vector<double> last;
    };
    std::vector<std::unique_ptr<Watch>> watches_; ///< by mapping; empty: nothing is watched
    struct Sampled {
        SampleSink* sink;
        std::unique_ptr<bus::SignalPublisher> ages; ///< real time
    };
    std::vector<Sampled> sampled_;
    std::unique_ptr<SamplePacer> pacer_; ///< last: its thread uses what stands above
    Moment last_;
    std::int64_t tick_begin_ns_{0}; ///< lockstep
    bool finished_{false};
};

/// The main function of a gateway: reads settings, checks mappings, runs. `describe` reads the program's own keys and
/// makes the table of them; the streams have been read when `complete` is called.
struct GatewayProgram {
    program::Declaration (*declaration)();
    std::function<void(config::Fields&)> describe;
    std::function<void(GatewaySettings&, bus::NodeConfig const&)> complete; ///< makes the table; may be empty
    std::function<std::unique_ptr<GatewayGuest>(DaemonRun&)> guest;         ///< may be empty
};
int run_gateway(GatewayProgram const& program, GatewaySettings& settings, int argc, char** argv);

} // namespace gridspace::gateways
