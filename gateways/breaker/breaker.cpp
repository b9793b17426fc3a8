// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-breaker: a breaker IED; the trip of a GOOSE stream becomes a command to the simulator's breakers. A gateway
// with one mapping, with signals and a log of its own.
#include "common/log.hpp"
#include "gateways/breaker/breaker_config.hpp"
#include "gateways/breaker/breaker_declaration.hpp"
#include "gateways/gateway/gateway.hpp"
#include "gateways/iec61850/quality.hpp"

#include <array>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

using config::Node;

/// The quality right behind the trip in its data set; empty: there is none.
std::string quality_of(BreakerConfig const& breaker, std::vector<streams::Stream> const& streams) {
    streams::Stream const* const stream = streams::find_stream(streams, breaker.stream().name);
    auto const leaves =
        stream == nullptr || stream->broken ? std::vector<iec61850::Leaf>{} : iec61850::leaves_of(stream->data_set);
    for (std::size_t i = 0; i + 1 < leaves.size(); ++i) {
        if (leaves[i].name == breaker.field() && leaves[i + 1].type == iec61850::BasicType::quality) {
            return leaves[i + 1].name;
        }
    }
    return "";
}

GatewayConfig table_of(BreakerConfig const& breaker, std::string const& process,
                       std::vector<streams::Stream> const& streams) {
    MappingConfig mapping;
    mapping.name = breaker.stream();
    mapping.from.stream = breaker.stream();
    mapping.to.topic = breaker.to;
    mapping.to.type.name = "TripCommand";
    mapping.accept_test = breaker.accept_test;
    mapping.judged_by = quality_of(breaker, streams);
    mapping.first_line = breaker.first_line;
    mapping.fields = Node::map();
    mapping.fields.set("source", Node::map()).set("value", Node::quoted_text(process));
    Node& status = mapping.fields.set("status", Node::map());
    status.set("from", Node::quoted_text(breaker.field(), breaker.from.where));
    if (breaker.on_loss == BreakerConfig::OnLoss::open) {
        status.set("on_loss", Node::scalar("true"));
    }
    GatewayConfig out;
    out.mappings.push_back(std::move(mapping));
    out.latency_us = breaker.latency_us;
    return out;
}

/// What a breaker IED shows in addition to the command itself.
class BreakerGuest final : public GatewayGuest {
  public:
    BreakerGuest(BreakerConfig const& config, DaemonRun& run) : config_{config}, run_{run} {}

    Result<void> prepare(bus::Node& node, std::vector<std::unique_ptr<Source>> const& sources) override {
        node_ = &node;
        clock_.emplace(node);
        Source& source = *sources.front();
        Route const& route = source.route();
        for (std::size_t i = 0; i < route.to.size(); ++i) {
            status_ = route.to[i].name == "status" ? i : status_;
        }
        for (mapping::Field const& field : route.from) {
            if (field.name == config_.field() && field.type != mapping::BasicType::boolean) {
                return fail(ExitCode::usage, fmt::format("stream '{}' has no Boolean member '{}'",
                                                         config_.stream().name, config_.field()));
            }
        }
        std::string const heard = "stream." + config_.stream().name + ".heard_";
        auto signals = bus::SignalPublisher::create(node, "breaker_ied", command_signals(), {});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        auto messages = bus::SignalPublisher::create(
            node, "messages", 0, {{heard + "st_num", ""}, {heard + "sq_num", ""}, {heard + "after_ms", "ms"}});
        if (!messages) {
            return std::unexpected{messages.error()};
        }
        messages_ = std::move(*messages);
        source.observe(
            {[this](Moment at, std::span<mapping::Value const> values) { commanded(at, values[status_].boolean()); },
             [this](Moment at, bool alive) { stream_is(at, alive); },
             [this](Moment at, iec61850::GooseFrame const& message, iec61850::GooseVerdict const&) {
                 heard_message(at, message);
             },
             [this](Moment at, std::uint32_t quality) { doubted(at, quality); }});
        return {};
    }

    void announce(SimTime now) override {
        signals_->announce(now);
        messages_->announce(now);
        publish(now);
    }

  private:
    void heard_message(Moment at, iec61850::GooseFrame const& message) {
        double const after_ms =
            clock_->simulated() ? static_cast<double>(at.ns) / 1e6 : clock_->age_ms(at.kernel_ns, 0, 1);
        std::array<double, 3> const row{static_cast<double>(message.st_num), static_cast<double>(message.sq_num),
                                        after_ms};
        messages_->row(at.time, row);
    }

    void stream_is(Moment at, bool alive) {
        alive_ = alive;
        if (!alive) {
            std::string const text =
                fmt::format("the stream '{}' is lost: {}", config_.stream().name,
                            config_.on_loss == BreakerConfig::OnLoss::hold ? "the state is held" : "opening");
            log::warning("{}", text);
            run_.status.event(node_->time_base().seconds(at.time), node_->config().process, "stream_lost", text);
        }
        publish(at.time);
    }

    void doubted(Moment at, std::uint32_t quality) {
        std::string const text = fmt::format("'{}' has the quality 0x{:04X}{}: the state is held", config_.from.name,
                                             quality, (quality & iec61850::quality::kTest) != 0 ? " (test)" : "");
        log::warning("{}", text);
        run_.status.event(node_->time_base().seconds(at.time), node_->config().process, "command_not_used", text);
    }

    /// Commands go out when they change, and once at the start.
    void commanded(Moment at, bool open) {
        if (command_ && *command_ == open) {
            return;
        }
        bool const first = !command_;
        command_ = open;
        SimTime const effect = at.time + node_->time_base().ceil(config_.latency_us / Rational{1'000'000});
        effect_ms_ = node_->time_base().seconds(effect) * 1e3;
        commanded_after_ms_ =
            clock_->simulated() ? node_->time_base().seconds(at.time) * 1e3 : clock_->age_ms(clock_->utc_ns(0), 0, 1);
        publish(at.time);
        if (!first || open) {
            run_.status.event(node_->time_base().seconds(at.time), node_->config().process, "command",
                              open ? "open" : "no trip");
        }
    }

    void publish(SimTime at) {
        std::array<double, 4> const row{command_.value_or(false) ? 1.0 : 0.0, alive_ ? 1.0 : 0.0, commanded_after_ms_,
                                        effect_ms_};
        signals_->row(at, row);
    }

    BreakerConfig const& config_;
    DaemonRun& run_;
    bus::Node* node_{nullptr};
    std::optional<WireClock> clock_;
    std::unique_ptr<bus::SignalPublisher> signals_, messages_;
    std::size_t status_{0};
    std::optional<bool> command_;
    bool alive_{false};
    double commanded_after_ms_{0}, effect_ms_{0}; ///< of the last command
};

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace::gateways;
    GatewaySettings settings;
    BreakerConfig breaker;
    GatewayProgram const program{
        breaker_declaration, [&](gridspace::config::Fields& f) { describe(f, breaker); },
        [&](GatewaySettings& s, gridspace::bus::NodeConfig const& node) {
            s.gateway = table_of(breaker, node.process, s.wire.streams);
        },
        [&](gridspace::DaemonRun& run) { return std::make_unique<BreakerGuest>(breaker, run); }};
    return run_gateway(program, settings, argc, argv);
}
