// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-ev: asks, every period, for the battery current that its EV needs (Eq. (1)-(2)).
#include "agents/ev/ev_config.hpp"
#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
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

class EvShell {
  public:
    EvShell(EvConfig const& config, bus::Node& node) : config_{config}, node_{node}, seen_(config.agents.size()) {}

    Result<void> run() {
        auto measurements = node_.reader<BusMeasurement>("bus_measurements");
        if (!measurements) {
            return std::unexpected{measurements.error()};
        }
        auto requests = node_.writer<ChargingRequest>("requests");
        if (!requests) {
            return std::unexpected{requests.error()};
        }
        if (auto ok = open_signals(); !ok) {
            return ok;
        }
        if (auto ok = node_.start(); !ok) {
            return ok;
        }
        TimeBase const& base = node_.time_base();
        SimSpan const period = base.nearest(config_.period_s),
                      latency = base.ceil(config_.latency_us / Rational{1'000'000});
        bus::TickGrid const grid{node_.config().clock};
        SimSpan const tick_span = base.nearest(node_.config().clock.tick_s);
        SimTime due; // the first request is at simulated time 0
        bool announced = false;
        while (true) {
            auto tick = node_.next();
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            if (!*tick) {
                return {};
            }
            if (!announced) {
                signals_->announce((*tick)->time);
                announced = true;
                // A late joiner starts with the next period, not with all the past ones.
                while (due + period <= (*tick)->time) {
                    due = due + period;
                }
            }
            // Nor does one that was paused: what it would have asked is of no use now.
            while (node_.lockstep() && due + tick_span <= (*tick)->time) {
                due = due + period;
            }
            for (auto const& received : (*measurements)->take()) {
                if (received.origin.time > due && due <= (*tick)->time) {
                    ask_all(**requests, due, latency);
                    due = due + period;
                }
                note(received.value, received.origin.time);
            }
            while (due <= (*tick)->time && measured(due, (*tick)->time, period)) {
                ask_all(**requests, due, latency);
                due = due + period;
            }
            if ((*tick)->final) {
                signals_->flush();
            }
            if (auto ok = node_.done(**tick, grid.tick_of(due)); !ok) {
                return ok;
            }
        }
    }

  private:
    Result<void> open_signals() {
        std::vector<bus::SignalColumn> columns;
        for (EvConfig::Agent const& agent : config_.agents) {
            std::string prefix = "agent." + node_.config().process;
            if (config_.agents.size() > 1) {
                prefix += "." + agent.ev.name;
            }
            columns.push_back({prefix + ".requested_a", "A"});
            columns.push_back({prefix + ".v_pu", "p.u."});
        }
        auto signals = bus::SignalPublisher::create(node_, "agent", 0, columns);
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        row_.assign(columns.size(), 0);
        return {};
    }

    /// Lockstep: what was measured at `due` is here. Real time: it may still be on its way; but not for long.
    bool measured(SimTime due, SimTime now, SimSpan period) const {
        bool const all = std::all_of(seen_.begin(), seen_.end(), [&](auto const& s) { return s && s->time >= due; });
        return node_.lockstep() || all || now >= due + SimSpan{period.quanta / 10};
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

    void ask_all(bus::Writer<ChargingRequest>& requests, SimTime now, SimSpan latency) {
        SimTime const effect = node_.effect_time(now, latency);
        double const elapsed_h = node_.time_base().seconds(now) / 3600;
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
            requests.write(request, effect);
            row_[2 * i] = request.current_a();
            row_[2 * i + 1] = request.v_pu();
        }
        signals_->row(effect, row_);
    }

    EvConfig const& config_;
    bus::Node& node_;
    std::vector<std::optional<Seen>> seen_; ///< by agent
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> row_;
};

} // namespace
} // namespace gridspace::agents

int main(int argc, char** argv) {
    using namespace gridspace;
    agents::EvConfig config;
    Daemon const daemon{"gridspace-ev",
                        "EV agent: asks for the charging current that its EV needs",
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                return agents::EvShell{config, node}.run();
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}
