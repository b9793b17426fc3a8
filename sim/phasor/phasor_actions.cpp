// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::phasor {

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
    auto const setting = setting_of(a, false);
    if (!setting) {
        return std::unexpected{setting.error()};
    }
    auto const [kind, element, quantity] = *setting;
    input_changed_ = true;
    if (std::size_t const i = index_of(network_.transformers, element);
        kind->section == "transformers" && i < network_.transformers.size()) {
        network_.transformers[i].tap_ratio = a.value;
        return set_topology();
    }
    if (kind->section == "generators" && set_generator(element, quantity->name, a.value)) {
        return set_topology();
    }
    if (std::size_t const i = index_of(network_.sources, element);
        kind->section == "sources" && i < network_.sources.size()) {
        if (auto const behind = sources_.find(i); behind != sources_.end()) {
            behind->second->change(t_, quantity->name, a.value);
        }
        if (quantity->name == "frequency_hz") {
            slopes_jump_ = true;
            return sources_.contains(i) ? Result<void>{} : std::unexpected{cannot_be_set(a, false)};
        }
        network_.sources[i].voltage_pu = a.value;
        if (sources_.contains(i)) {
            return {};
        }
        return set_topology(); // it holds its bus
    }
    bool const one_port = kind->section != "transformers" && kind->section != "sources";
    auto const it = one_port ? units_.find(element) : units_.end();
    bool const known = it != units_.end() && it->second.section == kind->section;
    return known && it->second.injection->set(quantity->name, a.value) ? Result<void>{}
                                                                       : std::unexpected{cannot_be_set(a, false)};
}

bool PhasorEngine::set_generator(std::string_view name, std::string_view quantity, double value) {
    std::size_t const i = index_of(network_.generators, name);
    if (i == network_.generators.size() || network_.generators[i].role == GeneratorRole::pq) {
        return false; // an injection
    }
    Generator& g = network_.generators[i];
    if (quantity == "voltage_setpoint_pu") {
        g.voltage_setpoint_pu = value;
    } else if (quantity == "p_kw" && g.role == GeneratorRole::pv) {
        g.p_kw = value;
    } else {
        return false;
    }
    return true;
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
    return put(a.element, false);
}

Result<void> PhasorEngine::act(Connect const& a) {
    return put(a.element, true);
}

Result<void> PhasorEngine::act(StandBy const& a) {
    auto const it = units_.find(a.element);
    if (it == units_.end() || it->second.kind == nullptr || !it->second.kind->stands_by) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be started or stopped: it is no converter", a.element));
    }
    it->second.injection->stand_by(a.on);
    return set_topology();
}

Result<void> PhasorEngine::put(std::string const& element, bool into_service) {
    if (auto const it = units_.find(element); it != units_.end()) {
        if (into_service && it->second.section == "machines") {
            return fail(ExitCode::usage, fmt::format("machine '{}' cannot be connected again", element),
                        "nothing brings it to the grid's angle before");
        }
        return connect(it->first, it->second, into_service);
    }
    if (std::size_t const i = index_of(network_.lines, element); i < network_.lines.size()) {
        switches_.line_out[i] = !into_service;
    } else if (std::size_t const j = index_of(network_.transformers, element); j < network_.transformers.size()) {
        switches_.transformer_out[j] = !into_service;
    } else if (find(network_.shunts, element) != nullptr) {
        if (into_service) {
            out_.erase(element);
        } else {
            out_.insert(element);
        }
    } else {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be {}connected: there is no such element at one bus, "
                                                 "generator with given power, line or transformer",
                                                 element, into_service ? "" : "dis"));
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
