// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/battery_gateway.hpp"

#include <battery_gateway.h>
#include <fmt/format.h>
#include <utility>

namespace gridspace::sim {

Result<std::unique_ptr<BatteryGateway>> BatteryGateway::create(bus::Node& node, Engine const& engine,
                                                               std::string const& battery) {
    auto gateway = std::unique_ptr<BatteryGateway>{new BatteryGateway{node, engine}};
    BatteryGateway& g = *gateway;
    auto writer = node.writer<BatteryMeasurement>("battery_measurements");
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    g.measurements_ = std::move(*writer);
    g.sample_ = std::make_unique<BatteryMeasurement>();
    g.sample_->battery(battery.c_str());
    if (!node.lockstep()) {
        constexpr std::size_t kSamples = 1024;
        g.outbox_ = std::make_unique<Outbox<BatteryMeasurement>>(kSamples);
    }
    for (auto [signal, name] : {std::pair{&g.soc_, ".soc_percent"}, {&g.p_, ".p_kw"}, {&g.q_, ".q_kvar"}}) {
        *signal = engine.find_signal("battery." + battery + name);
        if (*signal == engine.signals().size()) {
            return fail(ExitCode::usage, fmt::format("the solver has no signal 'battery.{}{}' for the gateway of the "
                                                     "battery",
                                                     battery, name));
        }
    }
    return gateway;
}

BatteryGateway::BatteryGateway(bus::Node& node, Engine const& engine) : node_{node}, engine_{engine} {}
BatteryGateway::~BatteryGateway() = default;

void BatteryGateway::publish(SimTime t) {
    sample_->time_ns(node_.time_base().nanoseconds(t));
    sample_->soc_percent(engine_.value(soc_));
    sample_->p_kw(engine_.value(p_));
    sample_->q_kvar(engine_.value(q_));
    if (outbox_ != nullptr) {
        outbox_->put(t, *sample_);
    } else {
        measurements_->write(*sample_, t);
    }
}

void BatteryGateway::drain(SimTime until) {
    outbox_->drain(until,
                   [this](BatteryMeasurement const& sample, SimTime time) { measurements_->write(sample, time); });
}

std::uint64_t BatteryGateway::lost() const {
    return outbox_ == nullptr ? 0 : outbox_->lost();
}

} // namespace gridspace::sim
