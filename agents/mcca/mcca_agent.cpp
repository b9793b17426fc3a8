// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-mcca: the microgrid control agent; collects the requests of a period and decides (Eq. (3)-(4)).
#include "agents/mcca/mcca_config.hpp"
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
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

class MccaAgent final : public bus::Member {
  public:
    MccaAgent(MccaConfig const& config, DaemonRun& run, bus::Node& node)
        : run_{run}, node_{node}, logic_{params_of(config, node.time_base())},
          latency_{node.time_base().ceil(config.latency_us / Rational{1'000'000})}, grid_{node.config().clock} {}

    Result<void> prepare() override {
        auto requests = node_.reader<ChargingRequest>("requests");
        if (!requests) {
            return std::unexpected{requests.error()};
        }
        requests_ = std::move(*requests);
        auto decisions = node_.writer<ChargingDecision>("decisions");
        if (!decisions) {
            return std::unexpected{decisions.error()};
        }
        decisions_ = std::move(*decisions);
        auto signals = bus::SignalPublisher::create(node_, "agent", mcca_declaration().signals, {});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        return {};
    }

    void begin(bus::Tick const& tick) override { signals_->announce(tick.time); }

    Result<void> work(bus::Tick const& tick) override {
        for (auto const& received : requests_->take()) {
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
        if (auto const out = logic_.elapse(tick.time)) {
            publish(*out);
        }
        if (tick.final) {
            signals_->flush();
        }
        return {};
    }

    std::uint64_t next_tick(bus::Tick const&) const override {
        auto const deadline = logic_.deadline();
        return deadline ? grid_.tick_of(*deadline) : bus::TickGrid::kNever;
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
    bus::TickGrid grid_;
    std::shared_ptr<bus::Reader<ChargingRequest>> requests_;
    std::set<std::string> refused_; ///< EVs whose last request was ignored
    std::unique_ptr<bus::Writer<ChargingDecision>> decisions_;
    std::unique_ptr<bus::SignalPublisher> signals_;
};

} // namespace
} // namespace gridspace::agents

int main(int argc, char** argv) {
    using namespace gridspace;
    agents::MccaConfig config;
    program::Declaration const declaration = agents::mcca_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                agents::MccaAgent agent{config, run, node};
                                return bus::run_member(node, agent);
                            });
                        },
                        true,
                        agents::mcca_declaration};
    return run_daemon(daemon, argc, argv);
}
