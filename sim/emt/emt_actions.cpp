// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

/// Changes while a simulation runs. They take effect at the present instant: the next step starts with them.
namespace gridspace::sim::emt {
namespace {

/// Faults nearer to each other than this share of a line are at one place.
constexpr double kSamePlace = 1e-9;

FaultBranch branch_of(ApplyFault const& a, int node) {
    FaultBranch f;
    f.node = node;
    f.r_ohm = a.resistance_ohm;
    f.name = a.name;
    switch (a.type) {
    case FaultType::three_phase_ground:
    case FaultType::three_phase:
        f.phases = {true, true, true};
        break;
    case FaultType::phase_ground:
        f.phases = {true, false, false};
        break;
    case FaultType::phase_phase:
    case FaultType::phase_phase_ground:
        f.phases = {false, true, true};
        break;
    }
    f.earthed = a.type != FaultType::three_phase && a.type != FaultType::phase_phase;
    return f;
}

} // namespace

Result<void> EmtEngine::apply(Action const& action) {
    return std::visit([this](auto const& a) { return act(a); }, action);
}

std::size_t EmtEngine::one_port_named(std::string_view name) const {
    auto const it =
        std::find_if(one_ports_.begin(), one_ports_.end(), [&](OnePort const* e) { return e->name.name == name; });
    return static_cast<std::size_t>(it - one_ports_.begin());
}

Result<void> EmtEngine::act(SwitchBreaker const& a) {
    std::vector<LineSwitch const*> const at_lines = all<LineSwitch>(std::as_const(network_));
    Opening how;
    std::optional<int> index;
    for (std::size_t i = 0; i < at_lines.size(); ++i) {
        if (at_lines[i]->name.name == a.breaker) {
            index = parts_.line_switch[i];
            how = at_lines[i]->opening(NetworkAround{network_});
        }
    }
    if (std::size_t const i = one_port_named(a.breaker);
        i < one_ports_.size() && one_ports_[i]->kind().follows(Command::open)) {
        index = parts_.one_ports[i].breaker;
    }
    if (!index) {
        return fail(ExitCode::usage, fmt::format("there is no breaker '{}'", a.breaker));
    }
    if (a.close) {
        solver_.close_switch(static_cast<std::size_t>(*index));
    } else {
        how.poles = a.poles;
        solver_.open_switch(static_cast<std::size_t>(*index), how);
    }
    return {};
}

int EmtEngine::far_node(TwoPortParts::Section const& section) const {
    using Kind = TwoPortParts::Section::Kind;
    Circuit const& c = solver_.circuit();
    auto const i = static_cast<std::size_t>(section.index);
    switch (section.kind) {
    case Kind::rl:
        return c.rl[i].to;
    case Kind::coupled:
        return c.coupled[i].to;
    case Kind::wave:
        return c.bergeron[i].to;
    case Kind::marti:
        return c.marti[i].to;
    }
    return kEarth;
}

/// Cuts a section of a line in two and returns the node between them.
Result<int> EmtEngine::cut(TwoPortParts& line, std::size_t s, double place, std::string const& name) {
    using Section = TwoPortParts::Section;
    Section& first = line.sections[s];
    Section second = first;
    double const share = (place - first.start) / (first.end - first.start);
    switch (first.kind) {
    case Section::Kind::rl:
        second.index = solver_.split_rl(first.index, share, name);
        break;
    case Section::Kind::coupled:
        second.index = solver_.split_coupled(first.index, share, name);
        break;
    case Section::Kind::wave: {
        auto const parts = solver_.split_wave(first.index, share, name);
        first.index = parts.near_index;
        second.index = parts.far_index;
        first.kind = parts.near_is_wave ? Section::Kind::wave : Section::Kind::rl;
        second.kind = parts.far_is_wave ? Section::Kind::wave : Section::Kind::rl;
        break;
    }
    case Section::Kind::marti: // the line refused before
        return fail(ExitCode::usage, fmt::format("{} has no node", name));
    }
    second.start = place;
    first.end = place;
    int const middle = far_node(first);
    line.sections.insert(line.sections.begin() + static_cast<std::ptrdiff_t>(s) + 1, second);
    // What flows at the ends of the line is now that of the outermost sections.
    auto const terms_of = [&](int index) -> std::vector<CurrentTerm>& {
        return solver_.circuit().switches[static_cast<std::size_t>(index)].terms;
    };
    auto const series = [](CurrentTerm const& t) {
        using Kind = CurrentTerm::Kind;
        return t.kind == Kind::rl || t.kind == Kind::coupled || t.kind == Kind::bergeron_from ||
               t.kind == Kind::bergeron_to;
    };
    auto const outermost = [](Section const& section, bool at_from) -> CurrentTerm {
        using Kind = CurrentTerm::Kind;
        if (section.kind == Section::Kind::wave) {
            return {at_from ? Kind::bergeron_from : Kind::bergeron_to, section.index, 1};
        }
        return {section.kind == Section::Kind::rl ? Kind::rl : Kind::coupled, section.index, at_from ? 1.0 : -1.0};
    };
    for (CurrentTerm& term : terms_of(line.from_switch)) {
        term = series(term) ? outermost(line.sections.front(), true) : term;
    }
    for (CurrentTerm& term : terms_of(line.to_switch)) {
        term = series(term) ? outermost(line.sections.back(), false) : term;
    }
    return middle;
}

Result<int> EmtEngine::fault_place(ApplyFault const& a) {
    if (!a.bus.empty()) {
        std::size_t const bus = index_of(network_.buses, a.bus);
        if (bus == network_.buses.size()) {
            return fail(ExitCode::usage, fmt::format("there is no bus '{}'", a.bus));
        }
        return parts_.bus_node[bus];
    }
    auto const found =
        std::find_if(two_ports_.begin(), two_ports_.end(), [&](TwoPort const* e) { return e->name.name == a.line; });
    auto const index = static_cast<std::size_t>(found - two_ports_.begin());
    if (found == two_ports_.end() || parts_.two_ports[index].sections.empty()) {
        return fail(ExitCode::usage, fmt::format("there is no line '{}'", a.line));
    }
    if (!(a.position_percent >= 0 && a.position_percent <= 100)) {
        return fail(ExitCode::usage,
                    fmt::format("a fault at {} % of line '{}' is not on it", shortest(a.position_percent), a.line));
    }
    if (auto const refusal = (*found)->refuses_fault(a.position_percent)) {
        return fail(ExitCode::usage,
                    fmt::format("a fault at {} % of line '{}' cannot be: {}", shortest(a.position_percent), a.line,
                                refusal->why),
                    std::string{refusal->hint});
    }
    TwoPortParts& line = parts_.two_ports[index];
    double const place = a.position_percent / 100;
    if (place <= kSamePlace) {
        return line.from_node;
    }
    if (place >= 1 - kSamePlace) {
        return line.to_node;
    }
    for (std::size_t s = 0; s < line.sections.size(); ++s) {
        auto& section = line.sections[s];
        if (std::abs(place - section.end) <= kSamePlace) {
            return far_node(section);
        }
        if (place > section.start && place < section.end) {
            return cut(line, s, place, fmt::format("line '{}' at {} %", a.line, shortest(a.position_percent)));
        }
    }
    return fail(ExitCode::usage, fmt::format("line '{}' has no place at {} %", a.line, shortest(a.position_percent)));
}

Result<void> EmtEngine::act(ApplyFault const& a) {
    auto const node = fault_place(a);
    if (!node) {
        return std::unexpected{node.error()};
    }
    Circuit& c = solver_.circuit();
    FaultBranch const branch = branch_of(a, *node);
    auto const [it, fresh] = faults_.try_emplace(a.name, c.faults.size());
    std::size_t const index = it->second;
    if (fresh) {
        c.faults.push_back(branch);
        // A fault at the very end of a line is beyond its breaker and CT.
        for (TwoPortParts const& line : parts_.two_ports) {
            for (auto const& [end, breaker] :
                 {std::pair{line.from_node, line.from_switch}, std::pair{line.to_node, line.to_switch}}) {
                if (end == *node) {
                    c.switches[static_cast<std::size_t>(breaker)].terms.push_back(
                        {CurrentTerm::Kind::fault, static_cast<int>(index), 1});
                }
            }
        }
    } else if (c.faults[index].node != *node) {
        return fail(ExitCode::usage, fmt::format("fault '{}' is already somewhere else", a.name),
                    "give it another name");
    } else {
        c.faults[index] = branch;
    }
    solver_.rebuild();
    solver_.apply_fault(index);
    return {};
}

Result<void> EmtEngine::act(ClearFault const& a) {
    auto const it = faults_.find(a.name);
    if (it == faults_.end()) {
        return fail(ExitCode::usage, fmt::format("there is no fault '{}' to clear", a.name));
    }
    solver_.clear_fault(it->second);
    return {};
}

Result<void> EmtEngine::act(Disconnect const& a) {
    auto const it = parts_.terminals.find(a.element);
    if (it == parts_.terminals.end()) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be disconnected: there is no such element", a.element),
                    "a line, transformer, source, generator, machine, load or shunt can");
    }
    for (std::size_t i = 0; i < converters_.size(); ++i) {
        NetworkCircuit::Injection const& injection = parts_.injections[i];
        if (std::find(it->second.begin(), it->second.end(), injection.breaker) != it->second.end()) {
            converters_[i].trip();
            phase_currents_[i].trip();
            injection.model->disconnect();
            std::fill_n(solver_.injected().begin() + static_cast<std::ptrdiff_t>(3 * i), 3, 0.0);
        }
    }
    for (int const breaker : it->second) {
        solver_.open_switch(static_cast<std::size_t>(breaker));
    }
    return {};
}

void EmtEngine::resume_converters(std::vector<int> const& switches) {
    std::complex<double> const turn = std::polar(1.0, -2 * std::numbers::pi / 3);
    for (std::size_t i = 0; i < converters_.size(); ++i) {
        NetworkCircuit::Injection const& injection = parts_.injections[i];
        if (converters_[i].tripped() &&
            std::find(switches.begin(), switches.end(), injection.breaker) != switches.end()) {
            Space const s = bus_voltage(injection.bus);
            std::complex<double> const v{s.alpha, s.beta};
            converters_[i].resume(v);
            phase_currents_[i].resume({v, v * turn, v * turn * turn});
        }
    }
}

Result<void> EmtEngine::act(Connect const& a) {
    auto const it = parts_.terminals.find(a.element);
    if (it == parts_.terminals.end()) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be connected: there is no such element", a.element));
    }
    if (std::size_t const i = one_port_named(a.element);
        i < one_ports_.size() && holding_of(*one_ports_[i]).keeps_alive) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' cannot be connected again: nothing brings it to the grid's angle", a.element));
    }
    resume_converters(it->second);
    for (int const breaker : it->second) {
        solver_.close_switch(static_cast<std::size_t>(breaker));
    }
    return {};
}

/// A voltage source stands by behind open poles.
void EmtEngine::stand_by(NetworkCircuit::OnePortParts const& parts, bool on) {
    auto const breaker = static_cast<std::size_t>(parts.breaker);
    if (on) {
        solver_.open_switch(breaker);
        return;
    }
    Space const s = bus_voltage(parts.bus);
    double const turned = 2 * std::numbers::pi * network_.frequency_hz * solver_.t();
    solver_.circuit().norton[static_cast<std::size_t>(parts.norton)].element->resume(
        solver_.t(), std::complex<double>{s.alpha, s.beta} * std::polar(1.0, -turned));
    solver_.close_switch(breaker);
}

Result<void> EmtEngine::act(StandBy const& a) {
    for (std::size_t k = 0; k < one_ports_.size(); ++k) {
        if (one_ports_[k]->name.name != a.element || !one_ports_[k]->kind().follows(Command::stop)) {
            continue;
        }
        if (parts_.one_ports[k].norton >= 0) {
            stand_by(parts_.one_ports[k], a.on);
        }
        for (std::size_t i = 0; i < converters_.size(); ++i) {
            if (parts_.injections[i].breaker == parts_.one_ports[k].breaker) {
                converters_[i].stand_by(a.on);
                parts_.injections[i].model->disconnect();
            }
        }
        return {};
    }
    return fail(ExitCode::usage, fmt::format("'{}' cannot be started or stopped: it is no converter", a.element));
}

} // namespace gridspace::sim::emt
