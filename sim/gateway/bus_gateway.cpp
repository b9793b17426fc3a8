// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/bus_gateway.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <bus_gateway.h>
#include <ev_charging.h>
#include <fmt/format.h>

namespace gridspace::sim {

Result<std::unique_ptr<BusGateway>> BusGateway::create(bus::Node& node, Engine& engine, Network const& network,
                                                       std::string const& bus) {
    auto gateway = std::unique_ptr<BusGateway>{new BusGateway};
    BusGateway& g = *gateway;
    g.node_ = &node;
    g.engine_ = &engine;
    auto writer = node.writer<BusMeasurement>("bus_measurements");
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    g.measurements_ = std::move(*writer);
    g.sample_ = std::make_unique<BusMeasurement>();
    if (!node.lockstep()) {
        constexpr std::size_t kSamples = 1024;
        g.outbox_ = std::make_unique<Outbox<BusMeasurement>>(kSamples);
    }
    g.sample_->bus(bus.c_str());
    std::string const prefix = "bus." + bus;
    g.p_ = consumed(engine, network, bus, ".p_kw");
    g.q_ = consumed(engine, network, bus, ".q_kvar");
    for (auto [signal, name] :
         {std::pair{&g.v_, ".v_pu"}, {&g.angle_, ".angle_deg"}, {&g.frequency_, ".frequency_hz"}}) {
        *signal = engine.find_signal(prefix + name);
        if (*signal == engine.signals().size()) {
            return fail(ExitCode::usage,
                        fmt::format("the solver has no signal '{}{}' for the gateway of the bus", prefix, name));
        }
    }
    std::vector<std::string> names;
    for (Ev const& ev : network.evs) {
        if (ev.bus.name == bus) {
            std::string const name = "ev." + ev.name.name;
            names.push_back(ev.name.name);
            g.evs_.push_back({engine.find_signal(name + ".soc_percent"), engine.find_signal(name + ".current_a"),
                              engine.find_signal(name + ".reference_a")});
            EvMeasurement measurement;
            measurement.ev(ev.name.name.c_str());
            measurement.connected(true);
            g.sample_->evs().push_back(measurement);
        }
    }
    if (g.evs_.size() > MAX_EVS_PER_BUS) {
        return fail(ExitCode::usage, fmt::format("bus '{}' has {} EVs, and {} fit into a measurement", bus,
                                                 g.evs_.size(), MAX_EVS_PER_BUS));
    }
    g.orders_ = std::make_unique<ChargingOrders>(node.time_base(), names);
    if (!g.evs_.empty()) {
        auto reader = node.reader<ChargingDecision>("decisions");
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        g.decisions_ = std::move(*reader);
    }
    return gateway;
}

BusGateway::~BusGateway() = default;

std::vector<BusGateway::Term> BusGateway::consumed(Engine& engine, Network const& network, std::string const& bus,
                                                   std::string_view quantity) {
    std::size_t const none = engine.signals().size();
    if (std::size_t const signal = engine.find_signal(fmt::format("bus.{}{}", bus, quantity)); signal != none) {
        return {{signal, 1}};
    }
    std::vector<Term> out;
    for (OnePort const* e : all<OnePort>(network)) {
        std::size_t const signal = engine.find_signal(fmt::format("{}{}", signal_prefix(*e), quantity));
        if (e->bus.name == bus && signal != none) {
            out.push_back({signal, e->kind().feeds ? -1.0 : 1.0});
        }
    }
    return out;
}

double BusGateway::sum(std::vector<Term> const& terms) const {
    double out = -0.0; // the sum of one is that one, to its sign
    for (Term const& term : terms) {
        out += term.sign * engine_->value(term.signal);
    }
    return out;
}

void BusGateway::publish(SimTime t) {
    sample_->time_ns(node_->time_base().nanoseconds(t));
    sample_->v_pu(engine_->value(v_));
    sample_->angle_deg(engine_->value(angle_));
    sample_->frequency_hz(engine_->value(frequency_));
    sample_->p_kw(sum(p_));
    sample_->q_kvar(sum(q_));
    for (std::size_t i = 0; i < evs_.size(); ++i) {
        EvMeasurement& ev = sample_->evs()[i];
        ev.soc_percent(engine_->value(evs_[i].soc));
        ev.current_a(engine_->value(evs_[i].current));
        ev.current_reference_a(engine_->value(evs_[i].reference));
    }
    if (outbox_ != nullptr) {
        outbox_->put(t, *sample_);
    } else {
        measurements_->write(*sample_, t);
    }
}

void BusGateway::drain(SimTime until) {
    outbox_->drain(until, [this](BusMeasurement const& sample, SimTime time) { measurements_->write(sample, time); });
}

std::uint64_t BusGateway::lost() const {
    return outbox_ == nullptr ? 0 : outbox_->lost();
}

void BusGateway::take_commands(Simulation& simulation, SimTime until) {
    if (decisions_ == nullptr) {
        return;
    }
    for (auto const& received : decisions_->take()) {
        ChargingDecision const& decision = received.value;
        std::string_view const ev = decision.ev().c_str();
        if (!orders_->has(ev)) {
            continue; // for an EV at another bus
        }
        // In real time a command acts when it arrives; its delay is what it is.
        SimTime const effect =
            node_->lockstep() ? received.origin.time : std::max(received.origin.time, simulation.now());
        auto const fault = orders_->take(simulation, effect, ev, decision.current_a(), decision.valid_for_s());
        if (fault && on_refusal_) {
            on_refusal_(effect, fmt::format("decision of {} for {}: {}, ignored", node_->process_name(received.origin),
                                            ev, *fault));
        }
    }
    orders_->expire(simulation, until);
}

} // namespace gridspace::sim
