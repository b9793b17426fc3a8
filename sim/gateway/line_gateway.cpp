// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/line_gateway.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <protection.h>

namespace gridspace::sim {

Result<std::unique_ptr<LineGateway>> LineGateway::create(bus::Node& node, Engine& engine, Network const& network,
                                                         LineGatewayConfig const& config,
                                                         SamplingConfig const& sampling) {
    auto gateway = std::unique_ptr<LineGateway>{new LineGateway};
    LineGateway& g = *gateway;
    g.node_ = &node;
    g.engine_ = &engine;
    Rational const period_s = Rational{1} / sampling.rate_hz;
    if (!(period_s / node.time_base().quantum_s()).is_whole()) {
        return fail(ExitCode::usage,
                    fmt::format("a sampling period of {} s does not fall on the time grid of {} s",
                                period_s.to_string(), node.time_base().quantum_s().to_string()),
                    "choose a step of which the sampling period is a whole multiple");
    }
    g.sample_span_ = node.time_base().nearest(period_s);
    // In lockstep nobody may wait for a sample of a tick that is over: a message ends with its tick (flush).
    g.samples_per_message_ = static_cast<std::size_t>(sampling.samples_per_message);
    for (LineGatewayConfig::Publish const& publish : config.publish) {
        Transformer transformer;
        for (std::size_t phase = 0; phase < 3; ++phase) {
            std::string const name = fmt::format("ct.{}.i.{}", publish.transformer.name, "abc"[phase]);
            transformer.phases[phase] = engine.find_signal(name);
            if (transformer.phases[phase] == engine.signals().size()) {
                return fail(ExitCode::usage,
                            fmt::format("the solver has no signal '{}' for the gateway '{}'", name, config.name.name),
                            "sampled currents need `solver: emt`");
            }
        }
        transformer.message = std::make_unique<LineCurrents>();
        transformer.message->transformer(publish.transformer.name.c_str());
        transformer.message->rate_num(static_cast<std::uint32_t>(sampling.rate_hz.num()));
        transformer.message->rate_den(static_cast<std::uint32_t>(sampling.rate_hz.den()));
        transformer.message->samples().reserve(MAX_SAMPLES_PER_MESSAGE);
        auto writer = node.writer<LineCurrents>(publish.topic.name);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        transformer.writer = std::move(*writer);
        if (!node.lockstep()) {
            constexpr std::size_t kMessages = 4096; // seconds
            transformer.outbox = std::make_unique<Outbox<LineCurrents>>(kMessages);
        }
        g.transformers_.push_back(std::move(transformer));
    }
    for (LineGatewayConfig::Subscribe const& subscribe : config.subscribe) {
        Trip trip;
        for (Ref const& breaker : subscribe.breakers) {
            trip.breakers.push_back(breaker.name);
            Breaker const* const switched = find(network.breakers, breaker.name);
            BreakerType const* const type =
                switched == nullptr ? nullptr : find(network.breaker_types, switched->type.name);
            trip.follows.push_back(type != nullptr && !type->latched);
        }
        auto reader = node.reader<TripCommand>(subscribe.topic.name);
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        trip.commands = std::move(*reader);
        g.trips_.push_back(std::move(trip));
    }
    return gateway;
}

LineGateway::~LineGateway() = default;

void LineGateway::observe(SimTime t) {
    if (t.quanta % sample_span_.quanta != 0) {
        return;
    }
    last_sample_ = t;
    for (Transformer& transformer : transformers_) {
        auto& samples = transformer.message->samples();
        if (samples.empty()) {
            transformer.message->first_index(static_cast<std::uint64_t>(t.quanta / sample_span_.quanta));
        }
        PhaseCurrents currents;
        currents.ia(static_cast<float>(engine_->value(transformer.phases[0])));
        currents.ib(static_cast<float>(engine_->value(transformer.phases[1])));
        currents.ic(static_cast<float>(engine_->value(transformer.phases[2])));
        samples.push_back(currents);
        if (samples.size() >= samples_per_message_) {
            send(transformer);
        }
    }
}

void LineGateway::send(Transformer& transformer) {
    LineCurrents& message = *transformer.message;
    message.time_ns(node_->time_base().nanoseconds(last_sample_));
    if (transformer.outbox != nullptr) {
        transformer.outbox->put(last_sample_, message);
    } else {
        transformer.writer->write(message, last_sample_);
    }
    message.samples().clear();
}

void LineGateway::flush() {
    for (Transformer& transformer : transformers_) {
        if (!transformer.message->samples().empty()) {
            send(transformer);
        }
    }
}

void LineGateway::drain(SimTime until) {
    for (Transformer& transformer : transformers_) {
        transformer.outbox->drain(
            until, [&](LineCurrents const& message, SimTime time) { transformer.writer->write(message, time); });
    }
}

std::uint64_t LineGateway::lost() const {
    std::uint64_t lost = 0;
    for (Transformer const& transformer : transformers_) {
        lost += transformer.outbox == nullptr ? 0 : transformer.outbox->lost();
    }
    return lost;
}

/// In real time a command acts when it says, or when it arrives if that is later. What lies far ahead is a stamp of
/// somebody else's time: then at once, for a trip must not wait.
SimTime LineGateway::realtime_effect(std::int64_t time_ns, SimTime now) const {
    constexpr std::int64_t kFarNs = 100'000'000;
    bool const plausible = time_ns > 0 && time_ns - node_->time_base().nanoseconds(now) < kFarNs;
    return plausible ? std::max(node_->time_base().from_nanoseconds(time_ns), now) : now;
}

void LineGateway::take_commands(Simulation& simulation) {
    for (Trip& trip : trips_) {
        for (auto const& received : trip.commands->take()) {
            // A latched breaker ignores false. One that is not closes when the signal falls, and not at every
            // repetition of it.
            bool const open = received.value.status();
            if (!open && !trip.last) {
                continue;
            }
            trip.last = open;
            SimTime const effect =
                node_->lockstep() ? received.origin.time : realtime_effect(received.value.time_ns(), simulation.now());
            for (std::size_t i = 0; i < trip.breakers.size(); ++i) {
                if (open || trip.follows[i]) {
                    simulation.command(effect, SwitchBreaker{trip.breakers[i], !open});
                }
            }
        }
    }
}

} // namespace gridspace::sim
