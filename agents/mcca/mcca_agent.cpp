// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-mcca: the microgrid control agent; collects the requests of a period and decides (Eq. (3)-(4)).
#include "agents/mcca/mcca_config.hpp"
#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
#include "common/log.hpp"

#include <array>
#include <ev_charging.h>
#include <fmt/format.h>
#include <set>

namespace gridspace::agents {
namespace {

Mcca::Params params_of(MccaConfig const& config, TimeBase const& base) {
    Mcca::Params params;
    params.rules = config.rules;
    for (config::Ref const& ev : config.evs) {
        params.evs.push_back(ev.name);
    }
    params.request_timeout = base.nearest(config.request_timeout_s);
    return params;
}

class MccaShell {
  public:
    MccaShell(MccaConfig const& config, DaemonRun& run, bus::Node& node)
        : run_{run}, node_{node}, logic_{params_of(config, node.time_base())},
          latency_{node.time_base().ceil(config.latency_us / Rational{1'000'000})} {}

    Result<void> run() {
        auto requests = node_.reader<ChargingRequest>("requests");
        if (!requests) {
            return std::unexpected{requests.error()};
        }
        auto decisions = node_.writer<ChargingDecision>("decisions");
        if (!decisions) {
            return std::unexpected{decisions.error()};
        }
        decisions_ = std::move(*decisions);
        std::string const prefix = "agent." + node_.config().process;
        auto signals = bus::SignalPublisher::create(
            node_, "agent", 0,
            {{prefix + ".curtailed", ""}, {prefix + ".undervoltage", ""}, {prefix + ".complete", ""}});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        if (auto ok = node_.start(); !ok) {
            return ok;
        }
        bus::TickGrid const grid{node_.config().clock};
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
            }
            for (auto const& received : (*requests)->take()) {
                ChargingRequest const& r = received.value;
                MccaRequest const request{r.ev().c_str(), r.current_a(), r.v_pu(), r.period_s()};
                if (auto const fault = fault_of(request); fault && logic_.serves(request.ev)) {
                    refuse(received.origin, request.ev, *fault);
                    continue;
                }
                refused_.erase(request.ev);
                if (auto const out = logic_.request(received.origin.time, request)) {
                    publish(*out);
                }
            }
            if (auto const out = logic_.elapse((*tick)->time)) {
                publish(*out);
            }
            if ((*tick)->final) {
                signals_->flush();
            }
            auto const deadline = logic_.deadline();
            if (auto ok = node_.done(**tick, deadline ? grid.tick_of(*deadline) : bus::TickGrid::kNever); !ok) {
                return ok;
            }
        }
    }

  private:
    /// Once until the EV's requests make sense again.
    void refuse(bus::Origin const& origin, std::string const& ev, std::string const& fault) {
        if (refused_.insert(ev).second) {
            std::string const text =
                fmt::format("request of {} for {}: {}, ignored", node_.process_name(origin), ev, fault);
            log::warning("{}", text);
            run_.status.event(node_.time_base().seconds(origin.time), node_.config().process, "request_ignored", text);
        }
    }

    void publish(Mcca::Outcome const& outcome) {
        SimTime const effect = node_.effect_time(outcome.time, latency_);
        for (MccaDecision const& decided : outcome.decisions) {
            ChargingDecision decision;
            decision.ev(decided.ev.c_str());
            decision.time_ns(node_.time_base().nanoseconds(effect));
            decision.current_a(decided.current_a);
            // One period until the next decision is due, and one more during which the last one is kept.
            decision.valid_for_s(2 * outcome.period_s);
            decisions_->write(decision, effect);
        }
        std::array<double, 3> const row{outcome.curtailed ? 1.0 : 0.0, outcome.undervoltage ? 1.0 : 0.0,
                                        outcome.complete ? 1.0 : 0.0};
        signals_->row(effect, row);
        if (!outcome.complete) {
            std::string const text =
                fmt::format("decided with {} requests: the others did not ask in time", outcome.decisions.size());
            log::warning("{}", text);
            run_.status.event(node_.time_base().seconds(outcome.time), node_.config().process, "request_timeout", text);
        }
    }

    DaemonRun& run_;
    bus::Node& node_;
    Mcca logic_;
    SimSpan latency_;
    std::set<std::string> refused_; ///< EVs whose last request was ignored
    std::unique_ptr<bus::Writer<ChargingDecision>> decisions_;
    std::unique_ptr<bus::SignalPublisher> signals_;
};

} // namespace
} // namespace gridspace::agents

int main(int argc, char** argv) {
    using namespace gridspace;
    agents::MccaConfig config;
    Daemon const daemon{"gridspace-mcca",
                        "microgrid control agent: decides on the charging of all EVs",
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                return agents::MccaShell{config, run, node}.run();
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}
