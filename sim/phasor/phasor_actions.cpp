// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::phasor {

Result<void> PhasorEngine::act(SetChargingCurrent const& a) {
    auto const it = evs_.find(a.ev);
    if (it == evs_.end()) {
        return fail(ExitCode::usage, fmt::format("there is no EV '{}'", a.ev));
    }
    it->second->set_reference(a.current_a);
    input_changed_ = true;
    return {};
}

Result<void> PhasorEngine::act(SwitchBreaker const& a) {
    std::size_t const i = index_of(network_.breakers, a.breaker);
    if (i == network_.breakers.size()) {
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
    if (path.size() == 3 && path[0] == "loads" && path[2] == "p_kw") {
        if (auto const it = loads_.find(path[1]); it != loads_.end()) {
            it->second->set_power(a.value);
            input_changed_ = true;
            return {};
        }
    }
    if (path.size() == 3 && path[0] == "evs" && path[2] == "current_a" && a.value >= 0) {
        return act(SetChargingCurrent{path[1], a.value});
    }
    if (path.size() == 3 && path[0] == "batteries" && (path[2] == "p_kw" || path[2] == "q_kvar")) {
        if (auto const it = batteries_.find(path[1]); it != batteries_.end()) {
            Battery const& b = it->second->data();
            it->second->set_power(path[2] == "p_kw" ? a.value : b.p_kw, path[2] == "p_kw" ? b.q_kvar : a.value);
            input_changed_ = true;
            return {};
        }
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
                "loads.<name>.p_kw, machines.<name>.p_kw and .voltage_setpoint_pu, batteries.<name>.p_kw and "
                ".q_kvar, evs.<name>.current_a can");
}

Result<void> PhasorEngine::act(Disconnect const& a) {
    if (auto const it = switchable_.find(a.element); it != switchable_.end()) {
        it->second();
        out_.insert(a.element);
        return set_topology();
    }
    if (std::size_t const i = index_of(network_.lines, a.element); i < network_.lines.size()) {
        switches_.line_out[i] = true;
    } else if (std::size_t const j = index_of(network_.transformers, a.element); j < network_.transformers.size()) {
        switches_.transformer_out[j] = true;
    } else {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be disconnected: there is no such load, PV, EV, battery, "
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
