// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/sim_app.hpp"

#include "bus/clock_server.hpp"
#include "bus/tick_grid.hpp"
#include "common/lateness.hpp"
#include "common/log.hpp"
#include "common/pacer.hpp"
#include "common/realtime.hpp"
#include "common/text.hpp"
#include "sim/app/engine_factory.hpp"
#include "sim/app/publisher_thread.hpp"
#include "sim/app/signal_output.hpp"
#include "sim/gateway/battery_gateway.hpp"
#include "sim/gateway/bus_gateway.hpp"
#include "sim/gateway/control_gateway.hpp"
#include "sim/gateway/line_gateway.hpp"
#include "sim/runtime/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <thread>

namespace gridspace::sim {
namespace {

/// A tick by the wall clock, at the pace of the run; 0 where it has none.
std::chrono::nanoseconds tick_in_real_time(SimConfig const& config, bus::Node const& node) {
    double const tick_s = node.config().clock.tick_s.to_double();
    return std::chrono::nanoseconds{config.speed > 0 ? std::llround(tick_s / config.speed * 1e9) : 0};
}

/// The simulator's side of a co-simulation: engine, gateways, clock.
class SimApp {
  public:
    SimApp(SimConfig const& config, DaemonRun& run, bus::Node& node, Network network, std::unique_ptr<Engine> engine)
        : config_{config}, run_{run}, node_{node}, network_{std::move(network)},
          simulation_{std::move(engine),
                      {node.time_base(), node.time_base().nearest(config.simulation.step_s)},
                      timeline(config.events)},
          clock_{node, config.members}, pacer_{config.speed}, lateness_{tick_in_real_time(config, node)},
          duration_{SimTime{} + node.time_base().nearest(config.simulation.duration())}, grid_{node.config().clock} {}

    Result<void> run() {
        run_.on_stop([this] {
            stop_ = true;
            node_.request_stop();
        });
        struct ForgetStopHandler { // on every way out: a signal that comes while this object goes must not find it
            DaemonRun& run;
            ~ForgetStopHandler() { run.on_stop({}); }
        } const forget_at_the_end{run_};
        if (auto ok = prepare(); !ok) {
            return ok;
        }
        if (auto ok = clock_.start(); !ok) {
            return ok;
        }
        run_.status.ready();
        Result<void> const result = simulate();
        publisher_.reset();
        run_.on_stop({});
        if (!result) {
            if (!stop_) { // the cause reaches the launcher before its consequences do
                run_.status.failed(result.error());
            }
            clock_.abort();
        }
        log::info("{} ticks, {} overruns, worst {:.3f} ms late", clock_.ticks(), pacer_.overruns(),
                  static_cast<double>(pacer_.worst().count()) / 1e6);
        if (!node_.lockstep() && pacer_.paced()) {
            run_.status.lateness(lateness_.summary());
        }
        if (controls_ != nullptr && controls_->controls().refused() > 0) {
            log::info("{} set-points and commands refused", controls_->controls().refused());
        }
        return result;
    }

  private:
    Result<void> prepare() {
        config::Diagnostics diagnostics; // the scenario was checked; a hand-written file may still be wrong
        GatewaysConfig const gateways = read_gateways(config_.simulation.gateways, diagnostics);
        SamplingConfig const sampling = read_sampling(config_.simulation.sampling, diagnostics);
        std::vector<ControlConfig> const controls = read_controls(config_.simulation.controls, diagnostics);
        bool const waveform = config_.simulation.solver == SolverKind::emt;
        check_gateways(gateways, network_, diagnostics);
        check_controls(controls, network_, waveform, diagnostics);
        if (!diagnostics.ok()) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        if (!controls.empty()) {
            if (auto ok = open_controls(controls, waveform); !ok) {
                return ok;
            }
        }
        if (gateways.per_bus) {
            if (auto ok = open_gateways_per_bus(); !ok) {
                return ok;
            }
        }
        for (LineGatewayConfig const& line : gateways.lines) {
            auto gateway = LineGateway::create(node_, simulation_.engine(), network_, line, sampling);
            if (!gateway) {
                return std::unexpected{gateway.error()};
            }
            line_gateways_.push_back(std::move(*gateway));
        }
        auto signals = SignalOutput::create(node_, simulation_.engine(), config_);
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        for (StuckBreaker const& stuck : stuck_breakers(config_.events)) {
            simulation_.fail_to_open(stuck.breaker, SimTime{} + node_.time_base().nearest(stuck.from_s));
        }
        tell_of_events();
        return {};
    }

    Result<void> open_gateways_per_bus() {
        for (Bus const& bus : network_.buses) {
            auto gateway = BusGateway::create(node_, simulation_.engine(), network_, bus.name.name);
            if (!gateway) {
                return std::unexpected{gateway.error()};
            }
            (*gateway)->on_refusal([this](SimTime t, std::string const& text) {
                log::warning("{}", text);
                run_.status.event(node_.time_base().seconds(t), node_.config().process, "decision_ignored", text);
            });
            gateways_.push_back(std::move(*gateway));
        }
        for (Battery const& battery : network_.batteries) {
            auto gateway = BatteryGateway::create(node_, simulation_.engine(), battery.name.name);
            if (!gateway) {
                return std::unexpected{gateway.error()};
            }
            batteries_.push_back(std::move(*gateway));
        }
        return {};
    }

    void tell_of_events() {
        simulation_.on_failure([this](SimTime t, std::string const& breaker) {
            log::warning("breaker '{}' fails to open", breaker);
            run_.status.event(node_.time_base().seconds(t), breaker, "fails_to_open", "told to open, and stays closed");
        });
        simulation_.on_happening([this](Happening const& h) {
            log::info("{} '{}': {}", h.event, h.element, h.text);
            run_.status.event(h.at_s, h.element, h.event, h.text);
        });
        simulation_.on_event([this](SimTime t, TimedAction const& action) {
            log::info("event '{}'", action.event);
            run_.status.event(node_.time_base().seconds(t), node_.config().process, "event", action.event);
        });
    }

    Result<void> open_controls(std::vector<ControlConfig> const& configs, bool waveform) {
        auto gateway = ControlGateway::create(
            node_, network_, configs, waveform,
            {node_.time_base(), node_.time_base().nearest(config_.simulation.step_s), duration_});
        if (!gateway) {
            return std::unexpected{gateway.error()};
        }
        controls_ = std::move(*gateway);
        controls_->controls().on_event([this](SimTime t, std::string_view event, std::string const& text) {
            log::warning("{}", text);
            run_.status.event(node_.time_base().seconds(t), node_.config().process, std::string{event}, text);
        });
        simulation_.on_refusal([this](SimTime t, std::string const& what, Error const& error) {
            controls_->controls().refused_by_engine(t, what, error);
        });
        return {};
    }

    void observe(SimTime t) {
        for (auto const& gateway : gateways_) {
            gateway->publish(t);
        }
        for (auto const& battery : batteries_) {
            battery->publish(t);
        }
        for (auto const& gateway : line_gateways_) {
            gateway->observe(t);
        }
        signals_->observe(t);
    }

    Result<void> simulate() {
        auto const observer = [this](SimTime t) { observe(t); };
        double const duration_s = node_.time_base().seconds(duration_);
        signals_->announce({});
        if (!node_.lockstep()) {
            publisher_ =
                std::make_unique<PublisherThread>([this](SimTime end, bool final) { return publish(end, final); });
            step_below_the_others();
        }
        log::set_time(0);
        if (auto ok = simulation_.start(observer); !ok) {
            return ok;
        }
        start_the_pace(); // the steady state is there: what it took makes no tick late
        for (std::uint64_t k = 0;; ++k) {
            SimTime const end = std::min(grid_.end_of(k), duration_);
            log::set_time(node_.time_base().seconds(end));
            if (k > 0) {
                take_commands(end);
                if (auto const advanced = simulation_.run_until(end, observer); !advanced) {
                    return simulation_.refused_event() != nullptr ? advanced : broken_off(advanced.error());
                }
                // Lockstep or not, tick k is not published before its time at the wanted pace.
                pacer_.wait(node_.time_base().seconds(end), stop_);
                lateness_.add(pacer_.late());
            }
            for (auto const& gateway : line_gateways_) {
                gateway->flush();
            }
            bool const final = end == duration_;
            if (auto ok = publisher_ == nullptr ? publish(end, final) : hand_over(end, final); !ok) {
                return ok;
            }
            run_.status.progress(node_.time_base().seconds(end), duration_s, pacer_.overruns(), final);
            if (final) {
                return {};
            }
            if (stop_) {
                return fail(ExitCode::interrupted, "stopped");
            }
            if (node_.lockstep()) {
                pacer_.skip(run_.status.pause_if_asked(node_.time_base().seconds(end), stop_));
            }
            if (auto ok = hold_for_launcher(end); !ok) {
                return ok;
            }
        }
    }

    void take_commands(SimTime end) {
        for (auto const& gateway : gateways_) {
            gateway->take_commands(simulation_, end);
        }
        for (auto const& gateway : line_gateways_) {
            gateway->take_commands(simulation_);
        }
        if (controls_ != nullptr) {
            controls_->take_commands(simulation_, end);
        }
    }

    /// What the machine's clock shows at simulated time 0 is what ages of samples are measured from.
    void start_the_pace() {
        using namespace std::chrono;
        if (node_.lockstep()) {
            pacer_.start();
        } else if (config_.start_on_utc_second) { // smpCnt 0 falls on the second, as everybody else's
            clock_.set_start(pacer_.start_on_utc_second(stop_));
        } else {
            pacer_.start();
            clock_.set_start(duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count());
        }
    }

    /// The configuration was good enough to start with: a solver that ends later has met something else.
    [[nodiscard]] Result<void> broken_off(Error error) const {
        if (error.code == ExitCode::usage) {
            error.code = ExitCode::child_died;
            if (error.remedy.empty()) {
                std::string const asked = simulation_.last_request();
                error.remedy = fmt::format("what had changed just before is in events.ndjson of the run folder{}{}",
                                           asked.empty() ? "" : "; the last set-point or command was ", asked);
            }
        }
        return std::unexpected{std::move(error)};
    }

    /// What belongs to a tick, and the tick itself.
    Result<void> publish(SimTime end, bool final) {
        if (publisher_ != nullptr) {
            for (auto const& gateway : gateways_) {
                gateway->drain(end);
            }
            for (auto const& battery : batteries_) {
                battery->drain(end);
            }
            for (auto const& gateway : line_gateways_) {
                gateway->drain(end);
            }
            signals_->drain(end);
        }
        if (final) {
            signals_->flush();
        }
        return clock_.tick(end, final);
    }

    /// Real time: the publishing thread does it.
    Result<void> hand_over(SimTime end, bool final) {
        if (!publisher_->tick_ended(end, final)) {
            return publisher_->failed()
                       ? publisher_->finish()
                       : fail(ExitCode::stall, "the publishing thread cannot keep up with the simulation");
        }
        std::uint64_t lost = signals_->lost();
        for (auto const& gateway : gateways_) {
            lost += gateway->lost();
        }
        for (auto const& battery : batteries_) {
            lost += battery->lost();
        }
        for (auto const& gateway : line_gateways_) {
            lost += gateway->lost();
        }
        if (lost > 0) {
            return fail(
                ExitCode::stall,
                fmt::format("the publishing thread cannot keep up with the simulation: {} messages lost", lost));
        }
        return final ? publisher_->finish() : Result<void>{};
    }

    /// Process events of the timeline happen between two ticks, while nobody works.
    Result<void> hold_for_launcher(SimTime acknowledged) {
        while (next_hold_ < config_.holds_s.size() &&
               SimTime{} + node_.time_base().nearest(config_.holds_s[next_hold_]) <= acknowledged) {
            if (node_.lockstep()) {
                // A lost datagram is sent again within a heartbeat of 100 ms, but not by a process that is killed
                // before: what it sent would then reach some and not others.
                std::this_thread::sleep_for(std::chrono::milliseconds{250});
            }
            auto const answers = run_.status.hold(next_hold_, node_.lockstep());
            if (!answers) {
                return std::unexpected{answers.error()};
            }
            for (std::string const& answer : *answers) {
                if (auto ok = obey(split(answer, ' ')); !ok) {
                    return ok;
                }
            }
            ++next_hold_;
        }
        return {};
    }

    Result<void> obey(std::vector<std::string> const& words) {
        if (words.size() >= 2 && words[0] == "drop") {
            clock_.drop(words[1]);
        } else if (words.size() >= 2 && words[0] == "rejoin") {
            clock_.rejoin(words[1]);
        } else if (words.size() >= 3 && words[0] == "restarted") {
            return clock_.await_restarted(words[1],
                                          static_cast<std::uint32_t>(std::strtoul(words[2].c_str(), nullptr, 10)));
        }
        return {};
    }

    SimConfig const& config_;
    DaemonRun& run_;
    bus::Node& node_;
    Network network_;
    Simulation simulation_;
    bus::ClockServer clock_;
    Pacer pacer_;
    Lateness lateness_; ///< of ticks, in real time
    SimTime duration_;
    bus::TickGrid grid_;
    std::vector<std::unique_ptr<BusGateway>> gateways_;
    std::vector<std::unique_ptr<BatteryGateway>> batteries_;
    std::vector<std::unique_ptr<LineGateway>> line_gateways_;
    std::unique_ptr<ControlGateway> controls_; ///< where there is something to be steered
    std::unique_ptr<SignalOutput> signals_;
    std::unique_ptr<PublisherThread> publisher_; ///< real time; uses what stands above
    std::atomic<bool> stop_{false};
    std::size_t next_hold_{0};
};

} // namespace

void check(SimConfig const& config, config::Diagnostics& diagnostics) {
    if (auto const network = load_simulated_network(config.simulation, diagnostics)) {
        if (config.simulation.step_auto) {
            diagnostics.error({}, "simulation.step_s: auto is settled where a scenario is read",
                              "`gridspace run` does it; a number here");
        }
        check_events(config.events, *network, config.simulation.solver != SolverKind::phasor, diagnostics);
    }
}

Result<void> run(SimConfig const& config, DaemonRun& run) {
    config::Diagnostics diagnostics;
    auto network = load_simulated_network(config.simulation, diagnostics);
    if (!network) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    auto engine = make_engine(config.simulation, *network, TimeBase{run.bus.clock.quantum_s});
    if (!engine) {
        return std::unexpected{engine.error()};
    }
    return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
        return SimApp{config, run, node, std::move(*network), std::move(*engine)}.run();
    });
}

} // namespace gridspace::sim
