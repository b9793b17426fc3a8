// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::phasor {

bool PhasorEngine::set_quantity(std::string const& section, std::string const& element, std::string_view quantity,
                                double value) {
    auto const it = units_.find(element);
    if (it == units_.end() || it->second.kind == nullptr || it->second.kind->section != section) {
        return false;
    }
    auto const& known = it->second.kind->settable;
    bool const settable =
        std::any_of(known.begin(), known.end(), [&](Quantity const& q) { return q.name == quantity && q.in_phasors; });
    if (!settable || !it->second.injection->set(quantity, value)) {
        return false;
    }
    input_changed_ = true;
    return true;
}

Result<void> PhasorEngine::act(SetChargingCurrent const& a) {
    if (!set_quantity("evs", a.ev, "current_a", std::max(a.current_a, 0.0))) {
        return fail(ExitCode::usage, fmt::format("there is no EV '{}'", a.ev));
    }
    return {};
}

Result<void> PhasorEngine::act(SwitchBreaker const& a) {
    std::size_t const i = index_of(network_.breakers, a.breaker);
    if (i == network_.breakers.size()) {
        auto const it = units_.find(a.breaker);
        if (it != units_.end() && it->second.kind != nullptr && it->second.kind->switched) {
            return connect(it->first, it->second, a.close);
        }
        return fail(ExitCode::usage, fmt::format("there is no breaker '{}'", a.breaker));
    }
    std::erase_if(pending_, [&](auto const& p) { return p.second == i; });
    double const mechanism_s = find(network_.breaker_types, network_.breakers[i].type.name)->mechanism_ms * 1e-3;
    if (!a.close && switches_.breaker_closed[i] && mechanism_s > 0) {
        pending_.emplace(t_ + mechanism_s, i);
        return {};
    }
    switches_.breaker_closed[i] = a.close;
    return set_topology();
}

Result<void> PhasorEngine::open_breakers() {
    while (!pending_.empty() && pending_.begin()->first <= t_) {
        switches_.breaker_closed[pending_.begin()->second] = false;
        pending_.erase(pending_.begin());
    }
    if (auto ok = set_topology(); !ok) {
        return ok;
    }
    return restart();
}

bool PhasorEngine::opening(std::size_t breaker) const {
    return std::any_of(pending_.begin(), pending_.end(), [&](auto const& p) { return p.second == breaker; });
}

Result<void> PhasorEngine::act(SetParameter const& a) {
    std::vector<std::string> const path = split(a.path, '.');
    if (path.size() == 3 && set_quantity(path[0], path[1], path[2], a.value)) {
        return {};
    }
    for (std::size_t m = 0; m < machines_.size() && path.size() == 3 && path[0] == "machines"; ++m) {
        Machine& machine = network_.machines[m];
        if (path[1] != machine.name.name) {
            continue;
        }
        if (path[2] == "p_kw") {
            machines_[m]->setpoints().p_ref += (a.value - machine.p_kw) / machine.rating_kva;
            machine.p_kw = a.value;
        } else if (path[2] == "voltage_setpoint_pu") {
            machines_[m]->setpoints().v_ref += a.value - machine.voltage_setpoint_pu;
            machine.voltage_setpoint_pu = a.value;
        } else {
            break;
        }
        input_changed_ = true;
        return {};
    }
    return fail(ExitCode::usage, fmt::format("'{}' cannot be changed while a phasor simulation runs", a.path),
                settable_paths(true) + ", machines.<name>.p_kw and .voltage_setpoint_pu can");
}

Result<void> PhasorEngine::connect(std::string const& name, Unit const& unit, bool connected) {
    unit.injection->connect(connected);
    if (connected) {
        out_.erase(name);
    } else {
        out_.insert(name);
    }
    return set_topology();
}

Result<void> PhasorEngine::act(Disconnect const& a) {
    if (auto const it = units_.find(a.element); it != units_.end()) {
        return connect(it->first, it->second, false);
    }
    if (std::size_t const i = index_of(network_.lines, a.element); i < network_.lines.size()) {
        switches_.line_out[i] = true;
    } else if (std::size_t const j = index_of(network_.transformers, a.element); j < network_.transformers.size()) {
        switches_.transformer_out[j] = true;
    } else {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be disconnected: there is no such element at one bus, "
                                                 "generator with given power, line or transformer",
                                                 a.element));
    }
    return set_topology();
}

Result<void> PhasorEngine::act(ApplyFault const& a) {
    auto ok = faults_.apply(network_, a);
    return ok ? set_topology() : ok;
}

Result<void> PhasorEngine::act(ClearFault const& a) {
    auto ok = faults_.clear(a.name);
    return ok ? set_topology() : ok;
}

} // namespace gridspace::sim::phasor
