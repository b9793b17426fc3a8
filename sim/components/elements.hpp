// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/battery/battery.hpp"
#include "sim/components/ev/ev.hpp"
#include "sim/components/load/load.hpp"
#include "sim/components/pv/pv.hpp"
#include "sim/components/shunt/shunt.hpp"
#include "sim/components/shunt_capacitor/shunt_capacitor.hpp"

#include <tuple>
#include <vector>

namespace gridspace::sim {

/// The elements at one bus, by kind.
struct OnePorts {
    std::vector<Load> loads;
    std::vector<Shunt> shunts;
    std::vector<Pv> pv;
    std::vector<Ev> evs;
    std::vector<Battery> batteries;
    std::vector<ShuntCapacitor> shunt_capacitors;
};

/// The list of kinds, in the order in which everybody takes them up: sums, states and signals are in this order, so it
/// decides the last bits of results.
constexpr std::tuple kOnePorts{&OnePorts::loads, &OnePorts::shunts,    &OnePorts::pv,
                               &OnePorts::evs,   &OnePorts::batteries, &OnePorts::shunt_capacitors};

/// Calls visit(vector) for the elements of each kind.
template <class Elements, class Visit>
void for_each_kind(Elements& elements, Visit const& visit) {
    std::apply([&](auto... kind) { (visit(elements.*kind), ...); }, kOnePorts);
}

/// All of them, in the order of the list.
[[nodiscard]] inline std::vector<OnePort*> one_ports(OnePorts& elements) {
    std::vector<OnePort*> out;
    for_each_kind(elements, [&](auto& kind) {
        for (OnePort& e : kind) {
            out.push_back(&e);
        }
    });
    return out;
}
[[nodiscard]] inline std::vector<OnePort const*> one_ports(OnePorts const& elements) {
    std::vector<OnePort const*> out;
    for_each_kind(elements, [&](auto const& kind) {
        for (OnePort const& e : kind) {
            out.push_back(&e);
        }
    });
    return out;
}

} // namespace gridspace::sim
