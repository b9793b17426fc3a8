// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gridspace::sim::phasor {

Result<void> PhasorEngine::act(SwitchBreaker const& a) {
    std::vector<LineSwitch const*> const at_lines = all<LineSwitch>(std::as_const(network_));
    auto const found =
        std::find_if(at_lines.begin(), at_lines.end(), [&](LineSwitch const* s) { return s->name.name == a.breaker; });
    if (found == at_lines.end()) {
        if (Unit const* unit = unit_named(a.breaker);
            unit != nullptr && unit->injection && unit->element->kind().follows(Command::open)) {
            return connect(*unit, a.close);
        }
        return fail(ExitCode::usage, fmt::format("there is no breaker '{}'", a.breaker));
    }
    auto const i = static_cast<std::size_t>(found - at_lines.begin());
    std::erase_if(pending_, [&](auto const& p) { return p.second == i; });
    double const mechanism_s = (*found)->opening(NetworkAround{network_}).after_s;
    if (!a.close && switches_.switch_closed[i] && mechanism_s > 0) {
        pending_.emplace(t_ + mechanism_s, i);
        return {};
    }
    switches_.switch_closed[i] = a.close;
    return set_topology();
}

Result<void> PhasorEngine::open_breakers() {
    while (!pending_.empty() && pending_.begin()->first <= t_) {
        switches_.switch_closed[pending_.begin()->second] = false;
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
    auto const setting = setting_of(a, false);
    if (!setting) {
        return std::unexpected{setting.error()};
    }
    input_changed_ = true;
    for (TwoPort* e : all<TwoPort>(network_)) {
        if (setting->names(*e) && e->set(setting->quantity->name, a.value)) {
            return set_topology();
        }
    }
    for (Unit const& unit : units_) {
        if (setting->names(*unit.element)) {
            return set(unit, *setting->quantity, a.value) ? (unit.injection ? Result<void>{} : set_topology())
                                                          : std::unexpected{cannot_be_set(a, false)};
        }
    }
    return std::unexpected{cannot_be_set(a, false)};
}

bool PhasorEngine::set(Unit const& unit, Quantity const& quantity, double value) {
    if (!unit.element->set(quantity.name, value)) {
        return false;
    }
    if (!unit.injection) {
        return !quantity.turns_voltages; // it holds the angle of its bus
    }
    slopes_jump_ = slopes_jump_ || quantity.turns_voltages;
    return injections_[*unit.injection]->set(t_, quantity.name, value);
}

Result<void> PhasorEngine::connect(Unit const& unit, bool connected) {
    std::string const& name = unit.element->name.name;
    if (unit.injection) {
        injections_[*unit.injection]->connect(connected);
    }
    if (connected) {
        out_.erase(name);
    } else {
        out_.insert(name);
    }
    return set_topology();
}

Result<void> PhasorEngine::act(Disconnect const& a) {
    return put(a.element, false);
}

Result<void> PhasorEngine::act(Connect const& a) {
    return put(a.element, true);
}

Result<void> PhasorEngine::act(StandBy const& a) {
    Unit const* unit = unit_named(a.element);
    if (unit == nullptr || !unit->injection || !unit->element->kind().follows(Command::stop)) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be started or stopped: it is no converter", a.element));
    }
    PhasorInjection& injection = *injections_[*unit->injection];
    bool const resumes = !injection.connected() && !a.on;
    std::vector<double> const before = y_;
    if (resumes) {
        injection.resume(t_, dae_->voltage(injection.bus(), y_), dae_->states_of(*unit->injection, std::span{y_}));
    }
    injection.stand_by(a.on);
    auto ok = set_topology();
    constexpr double kDead = 1e-3, kLow = 1e-2; // p.u.: the search for voltages begins there
    for (std::size_t i = 0; resumes && unit->holding.keeps_alive && i < network_.buses.size(); ++i) {
        if (std::abs(dae_->voltage(i, before)) < kDead) {
            dae_->set_voltage(i, kLow, y_); // its voltage comes along a ramp
        }
    }
    return ok;
}

Result<void> PhasorEngine::act(SetMode const& a) {
    if (auto ok = check_mode(network_, a); !ok) {
        return ok;
    }
    if (Unit const* unit = unit_named(a.element); unit != nullptr && unit->injection) {
        injections_[*unit->injection]->set_mode(a.mode);
    }
    input_changed_ = true;
    return {};
}

Result<void> PhasorEngine::put(std::string const& element, bool into_service) {
    Unit const* unit = unit_named(element);
    CommandUse const* use = unit == nullptr ? nullptr : unit->element->kind().use(Command::disconnect);
    if (use != nullptr && use->in_phasors && !unit->holds_without_injection()) {
        if (into_service && unit->holding.keeps_alive) {
            return fail(ExitCode::usage, fmt::format("{} cannot be connected again", owner_of(*unit->element)),
                        "nothing brings it to the grid's angle before");
        }
        return connect(*unit, into_service);
    }
    std::vector<TwoPort const*> const elements = two_ports(network_);
    auto const found =
        std::find_if(elements.begin(), elements.end(), [&](TwoPort const* e) { return e->name.name == element; });
    if (found == elements.end()) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be {}connected: there is no such element at one bus, "
                                                 "generator with given power, line or transformer",
                                                 element, into_service ? "" : "dis"));
    }
    switches_.out[static_cast<std::size_t>(found - elements.begin())] = !into_service;
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
