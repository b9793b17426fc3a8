// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/line_gateway.hpp"
#include "sim/network/network.hpp"

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
    for (LineGatewayConfig::Publish const& publish : config.publish) {
        auto topic = SampledTopic::create(node, engine, publish, config.name.name, sampling);
        if (!topic) {
            return std::unexpected{topic.error()};
        }
        g.topics_.push_back(std::move(*topic));
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
    for (auto const& topic : topics_) {
        topic->sample(t, static_cast<std::uint64_t>(t.quanta / sample_span_.quanta));
    }
}

void LineGateway::flush() {
    for (auto const& topic : topics_) {
        topic->flush();
    }
}

void LineGateway::drain(SimTime until) {
    for (auto const& topic : topics_) {
        topic->drain(until);
    }
}

std::uint64_t LineGateway::lost() const {
    std::uint64_t lost = 0;
    for (auto const& topic : topics_) {
        lost += topic->lost();
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
