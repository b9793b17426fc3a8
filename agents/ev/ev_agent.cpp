// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-ev: asks, every period, for the battery current that its EV needs (Eq. (1)-(2)).
#include "agents/ev/ev_config.hpp"
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <bus_gateway.h>
#include <ev_charging.h>
#include <optional>

namespace gridspace::agents {
namespace {

/// What the agent has last seen of its EV.
struct Seen {
    SimTime time;
    double v_pu;
    double soc_percent;
};

class EvAgent final : public bus::Member {
  public:
    EvAgent(EvConfig const& config, bus::Node& node)
        : config_{config}, node_{node}, period_{node.time_base().nearest(config.period_s)},
          latency_{node.time_base().ceil(config.latency_us / Rational{1'000'000})}, grid_{node.config().clock},
          seen_(config.agents.size()) {}

    Result<void> prepare() override {
        auto measurements = node_.reader<BusMeasurement>("bus_measurements");
        if (!measurements) {
            return std::unexpected{measurements.error()};
        }
        measurements_ = std::move(*measurements);
        auto requests = node_.writer<ChargingRequest>("requests");
        if (!requests) {
            return std::unexpected{requests.error()};
        }
        requests_ = std::move(*requests);
        return open_signals();
    }

    void begin(bus::Tick const& tick) override {
        signals_->announce(tick.time);
        while (due_ + period_ <= tick.time) { // a late joiner starts with the next period, not with all the past ones
            due_ = due_ + period_;
        }
    }

    Result<void> work(bus::Tick const& tick) override {
        // Who was paused starts anew as well: what it would have asked is of no use now.
        while (node_.is_over(due_, tick)) {
            due_ = due_ + period_;
        }
        for (auto const& received : measurements_->take()) {
            if (received.origin.time > due_ && due_ <= tick.time) {
                ask_all();
            }
            note(received.value, received.origin.time);
        }
        while (due_ <= tick.time && measured(tick.time)) {
            ask_all();
        }
        if (tick.final) {
            signals_->flush();
        }
        return {};
    }

    std::uint64_t next_tick(bus::Tick const&) const override { return grid_.tick_of(due_); }

  private:
    Result<void> open_signals() {
        std::vector<std::string> evs;
        for (EvConfig::Agent const& agent : config_.agents) {
            evs.push_back(agent.ev.name);
        }
        auto signals =
            bus::SignalPublisher::create(node_, "agent", ev_declaration().signals, {{"evs", std::move(evs)}});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        row_.assign(2 * config_.agents.size(), 0);
        return {};
    }

    /// Lockstep: what was measured when a request is due is here. Real time: it may still be on its way; but not for
    /// long.
    bool measured(SimTime now) const {
        bool const all = std::all_of(seen_.begin(), seen_.end(), [&](auto const& s) { return s && s->time >= due_; });
        return all || node_.has_come(due_) || now >= due_ + SimSpan{period_.quanta / 10};
    }

    void note(BusMeasurement const& measurement, SimTime time) {
        for (std::size_t i = 0; i < config_.agents.size(); ++i) {
            if (config_.agents[i].bus != measurement.bus().c_str()) {
                continue;
            }
            for (EvMeasurement const& ev : measurement.evs()) {
                if (config_.agents[i].ev.name == ev.ev().c_str()) {
                    seen_[i] = Seen{time, measurement.v_pu(), ev.soc_percent()};
                }
            }
        }
    }

    /// For what is due now; the next request is due a period later.
    void ask_all() {
        SimTime const effect = node_.effect_time(due_, latency_);
        double const elapsed_h = node_.time_base().seconds(due_) / 3600;
        due_ = due_ + period_;
        for (std::size_t i = 0; i < config_.agents.size(); ++i) {
            EvConfig::Agent const& agent = config_.agents[i];
            if (!seen_[i]) {
                log::warning("no measurement of {} at {} yet: no request", agent.ev.name, agent.bus);
                continue;
            }
            ChargingRequest request;
            request.ev(agent.ev.name.c_str());
            request.time_ns(node_.time_base().nanoseconds(effect));
            request.current_a(requested_current_a(agent.params, seen_[i]->soc_percent, elapsed_h));
            request.v_pu(seen_[i]->v_pu);
            request.soc_percent(seen_[i]->soc_percent);
            request.period_s(config_.period_s.to_double());
            requests_->write(request, effect);
            row_[2 * i] = request.current_a();
            row_[2 * i + 1] = request.v_pu();
        }
        signals_->row(effect, row_);
    }

    EvConfig const& config_;
    bus::Node& node_;
    SimSpan period_, latency_;
    bus::TickGrid grid_;
    SimTime due_;                           ///< when it asks next; the first request is at simulated time 0
    std::vector<std::optional<Seen>> seen_; ///< by agent
    std::shared_ptr<bus::Reader<BusMeasurement>> measurements_;
    std::unique_ptr<bus::Writer<ChargingRequest>> requests_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> row_;
};

} // namespace
} // namespace gridspace::agents

int main(int argc, char** argv) {
    using namespace gridspace;
    agents::EvConfig config;
    program::Declaration const declaration = agents::ev_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                agents::EvAgent agent{config, node};
                                return bus::run_member(node, agent);
                            });
                        },
                        true,
                        agents::ev_declaration};
    return run_daemon(daemon, argc, argv);
}
