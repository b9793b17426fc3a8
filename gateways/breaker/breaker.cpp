// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-breaker: a breaker IED; the trip of a GOOSE stream becomes a command to the simulator's breakers.
#include "bus/daemon.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
#include "common/log.hpp"
#include "gateways/breaker/breaker_config.hpp"
#include "gateways/port/subscriptions.hpp"
#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"

#include <array>
#include <fmt/format.h>
#include <protection.h>

namespace gridspace::gateways {
namespace {

struct Settings {
    BreakerConfig breaker;
    WireConfig wire;
};

class BreakerIed {
  public:
    BreakerIed(Settings const& settings, DaemonRun& run, bus::Node& node)
        : settings_{settings}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock},
          latency_{node.time_base().ceil(settings.breaker.latency_us / Rational{1'000'000})} {}

    Result<void> run() {
        if (auto ok = prepare(); !ok) {
            return ok;
        }
        while (true) {
            auto const deadline = subscriber_->deadline();
            auto tick = node_.lockstep() ? node_.next() : node_.next(deadline ? std::optional{WireClock::wall(*deadline)} : std::nullopt);
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            if (!*tick) {
                return {};
            }
            if (!announced_) {
                announced_ = true;
                signals_->announce((*tick)->time);
                messages_->announce((*tick)->time);
                publish_state((*tick)->time);
            }
            for (bus::WireFrame const* frame : port_->take(iec61850::kGooseEthertype)) {
                std::int64_t const now = node_.lockstep() ? clock_.of(frame->time) : clock_.now();
                expire(now - 1);
                receive(*frame, now);
            }
            expire(node_.lockstep() ? clock_.of((*tick)->time) : clock_.now());
            port_->maintain();
            auto const next = subscriber_->deadline();
            if (auto ok = node_.done(**tick, next ? grid_.tick_of(clock_.at_or_after(*next)) : bus::TickGrid::kNever); !ok) {
                return ok;
            }
        }
    }

  private:
    Result<void> prepare() {
        config::Diagnostics diagnostics;
        BreakerConfig const& config = settings_.breaker;
        streams::Stream const* stream = stream_of(settings_.wire.streams, config.stream(), streams::Kind::goose, diagnostics);
        if (stream == nullptr) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        auto subscription = goose_subscription(*stream);
        subscription.simulation = config.accept_test;
        subscriber_ = std::make_unique<iec61850::GooseSubscriber>(std::move(subscription));
        auto const leaf = subscriber_->index_of(config.field());
        if (!leaf || subscriber_->leaves()[*leaf].type != iec61850::BasicType::boolean) {
            return fail(ExitCode::usage, fmt::format("stream '{}' has no Boolean member '{}'", stream->name.name, config.field()));
        }
        leaf_ = *leaf;
        auto port = WirePort::open(node_, settings_.wire, {{}, {stream->ethertype()}});
        if (!port) {
            return std::unexpected{port.error()};
        }
        port_ = std::move(*port);
        auto commands = node_.writer<TripCommand>(config.to.name);
        if (!commands) {
            return std::unexpected{commands.error()};
        }
        commands_ = std::move(*commands);
        std::string const prefix = "breaker_ied." + node_.config().process + ".";
        auto signals = bus::SignalPublisher::create(node_, "breaker_ied", 0, {{prefix + "command", ""}, {prefix + "stream_alive", ""}});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        std::string const heard = "stream." + stream->name.name + ".heard_";
        auto messages = bus::SignalPublisher::create(node_, "messages", 0, {{heard + "st_num", ""}, {heard + "sq_num", ""}, {heard + "after_ms", "ms"}});
        if (!messages) {
            return std::unexpected{messages.error()};
        }
        messages_ = std::move(*messages);
        return node_.start();
    }

    void receive(bus::WireFrame const& frame, std::int64_t now) {
        if (!iec61850::decode_goose(WirePort::octets(frame), decoded_)) {
            return; // counted by the recorder; nothing to act on
        }
        iec61850::GooseVerdict const verdict = subscriber_->receive(decoded_, now, clock_.utc_ns(now));
        if (verdict.event == iec61850::GooseEvent::not_ours) {
            return;
        }
        SimTime const at = node_.lockstep() ? frame.time : node_.latest_time();
        double const after_ms = node_.lockstep() ? static_cast<double>(now) / 1e6 : clock_.age_ms(frame.kernel_ns, 0, 1);
        std::array<double, 3> const row{static_cast<double>(decoded_.st_num), static_cast<double>(decoded_.sq_num), after_ms};
        messages_->row(at, row);
        if (!alive_ && verdict.accepted) {
            alive_ = true;
            publish_state(at);
        }
        if (!verdict.accepted) {
            log::warning("message refused: {}", iec61850::event_name(verdict.event));
            return;
        }
        command(subscriber_->value(leaf_).boolean(), at);
    }

    void expire(std::int64_t until) {
        auto const deadline = subscriber_->deadline();
        if (!deadline || *deadline > until || !subscriber_->expire(until)) {
            return;
        }
        alive_ = false;
        SimTime const at = node_.lockstep() ? clock_.at_or_after(*deadline) : node_.latest_time();
        std::string const text = fmt::format("the stream '{}' is lost: {}", settings_.breaker.stream().name,
                                             settings_.breaker.on_loss == BreakerConfig::OnLoss::hold ? "the state is held" : "opening");
        log::warning("{}", text);
        run_.status.event(node_.time_base().seconds(at), node_.config().process, "stream_lost", text);
        publish_state(at);
        if (settings_.breaker.on_loss == BreakerConfig::OnLoss::open) {
            command(true, at);
        }
    }

    /// Commands go out when they change, and once at the start.
    void command(bool open, SimTime at) {
        if (sent_ && *sent_ == open) {
            return;
        }
        bool const first = !sent_;
        sent_ = open;
        TripCommand sample;
        SimTime const effect = node_.effect_time(at, latency_);
        sample.source(node_.config().process.c_str());
        sample.time_ns(node_.time_base().nanoseconds(effect));
        sample.status(open);
        commands_->write(sample, effect);
        publish_state(at);
        if (!first || open) {
            run_.status.event(node_.time_base().seconds(at), node_.config().process, "command", open ? "open" : "no trip");
        }
    }

    void publish_state(SimTime at) {
        std::array<double, 2> const row{sent_.value_or(false) ? 1.0 : 0.0, alive_ ? 1.0 : 0.0};
        signals_->row(at, row);
    }

    Settings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    WireClock clock_;
    bus::TickGrid grid_;
    SimSpan latency_;
    std::unique_ptr<iec61850::GooseSubscriber> subscriber_;
    std::size_t leaf_{0};
    iec61850::GooseFrame decoded_;
    std::unique_ptr<WirePort> port_;
    std::unique_ptr<bus::Writer<TripCommand>> commands_;
    std::unique_ptr<bus::SignalPublisher> signals_, messages_;
    std::optional<bool> sent_;
    bool alive_{false}, announced_{false};
};

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace;
    gateways::Settings settings;
    Daemon const daemon{"gridspace-breaker", "breaker IED: the trip of a GOOSE stream becomes a command",
                        [&](config::Fields& f) {
                            describe(f, settings.breaker);
                            describe_wire(f, settings.wire);
                        },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> { return gateways::BreakerIed{settings, run, node}.run(); });
                        }};
    return run_daemon(daemon, argc, argv);
}
