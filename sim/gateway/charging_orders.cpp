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
    simulation.command(effect, SetChargingCurrent{order->ev, current_a});
    if (order->expires && *order->expires < effect) {
        simulation.command(*order->expires, SetChargingCurrent{order->ev, 0});
    }
    order->expires = end_of(effect, valid_for_s);
    return std::nullopt;
}

void ChargingOrders::expire(Simulation& simulation, SimTime until) {
    for (Order& order : orders_) {
        if (order.expires && *order.expires <= until) {
            simulation.command(*order.expires, SetChargingCurrent{order.ev, 0});
            order.expires.reset();
        }
    }
}

/// Longer than any run is as good as for ever: 30 years of nanoseconds still fit into 64 bits.
SimTime ChargingOrders::end_of(SimTime effect, double valid_for_s) const {
    constexpr double kLongestS = 1e9;
    auto const ns = static_cast<std::int64_t>(std::min(valid_for_s, kLongestS) * 1e9);
    SimSpan const span = base_.from_nanoseconds(ns) - SimTime{};
    return effect.quanta > INT64_MAX - span.quanta ? SimTime{INT64_MAX} : effect + span;
}

} // namespace gridspace::sim
