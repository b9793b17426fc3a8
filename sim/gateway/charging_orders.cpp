// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/charging_orders.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace gridspace::sim {
namespace {

std::optional<std::string> fault_of(double current_a, double valid_for_s) {
    auto const is = [](char const* field, double value) {
        return fmt::format("{} is {}", field, std::isnan(value) ? "nan" : shortest(value));
    };
    if (!std::isfinite(current_a)) {
        return is("current_a", current_a);
    }
    if (!std::isfinite(valid_for_s) || valid_for_s < 0) {
        return is("valid_for_s", valid_for_s);
    }
    return std::nullopt;
}

/// A charger gives nothing back: what is asked for below 0 is 0.
SetParameter current_of(std::string const& ev, double current_a) {
    return {"evs." + ev + ".current_a", std::max(current_a, 0.0)};
}

} // namespace

ChargingOrders::ChargingOrders(TimeBase base, std::vector<std::string> const& evs) : base_{base} {
    for (std::string const& ev : evs) {
        orders_.push_back({ev, {}});
    }
}

bool ChargingOrders::has(std::string_view ev) const {
    return std::any_of(orders_.begin(), orders_.end(), [&](Order const& order) { return order.ev == ev; });
}

std::optional<std::string> ChargingOrders::take(Simulation& simulation, SimTime effect, std::string_view ev,
                                                double current_a, double valid_for_s) {
    auto const order =
        std::find_if(orders_.begin(), orders_.end(), [&](Order const& candidate) { return candidate.ev == ev; });
    if (order == orders_.end()) {
        return std::nullopt;
    }
    if (auto fault = fault_of(current_a, valid_for_s)) {
        return std::exchange(order->refused, true) ? std::nullopt : std::move(fault);
    }
    order->refused = false;
    simulation.command(effect, current_of(order->ev, current_a));
    if (order->expires && *order->expires < effect) {
        simulation.command(*order->expires, current_of(order->ev, 0));
    }
    order->expires = base_.later(effect, valid_for_s);
    return std::nullopt;
}

void ChargingOrders::expire(Simulation& simulation, SimTime until) {
    for (Order& order : orders_) {
        if (order.expires && *order.expires <= until) {
            simulation.command(*order.expires, current_of(order.ev, 0));
            order.expires.reset();
        }
    }
}

} // namespace gridspace::sim
