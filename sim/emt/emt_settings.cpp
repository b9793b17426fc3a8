// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>

/// Quantities that are set while a simulation runs.
namespace gridspace::sim::emt {

Result<bool> EmtEngine::set_one_port(Setting const& setting, double value) {
    auto const it = std::find_if(one_ports_.begin(), one_ports_.end(), [&](OnePort const* e) {
        return e->kind().section == setting.kind->section && e->name.name == setting.element;
    });
    if (it == one_ports_.end()) {
        return false;
    }
    OnePort& found = **it;
    std::string_view const quantity = setting.quantity->name;
    if (auto const refusal = found.refuses(quantity)) {
        return fail(
            ExitCode::usage,
            fmt::format("'{}.{}.{}' cannot be set: {}", setting.kind->section, setting.element, quantity, refusal->why),
            std::string{refusal->hint});
    }
    if (!found.set(quantity, value)) {
        return false;
    }
    auto const index = static_cast<std::size_t>(it - one_ports_.begin());
    if (int const i = parts_.one_ports[index].injection; i >= 0) {
        parts_.injections[static_cast<std::size_t>(i)].model->set(quantity, value);
    }
    change_star(index);
    return true;
}

void EmtEngine::change_star(std::size_t index) {
    NetworkCircuit::OnePortParts& parts = parts_.one_ports[index];
    if (parts.resistance < 0) {
        return; // it has none: a converter
    }
    double const voltage_v = network_.buses[parts.bus].voltage_v;
    StarElements const e =
        star_elements(one_ports_[index]->admittance_kva(voltage_v), voltage_v, network_.frequency_hz);
    Circuit& c = solver_.circuit();
    auto& terms = c.switches[static_cast<std::size_t>(parts.breaker)].terms;
    auto const all = [](double x) { return PhaseMatrix::sequence(x, x); };
    c.rl[static_cast<std::size_t>(parts.resistance)].r = all(e.r_ohm);
    if (parts.inductance >= 0) {
        c.rl[static_cast<std::size_t>(parts.inductance)].l = all(e.l_h);
    } else if (e.l_h < kNothing) {
        parts.inductance = static_cast<int>(c.rl.size());
        c.rl.push_back({parts.node, kEarth, {}, all(e.l_h)});
        terms.push_back({CurrentTerm::Kind::rl, parts.inductance, 1});
    }
    if (parts.capacitance >= 0) {
        c.capacitors[static_cast<std::size_t>(parts.capacitance)].c = all(e.c_f);
    } else if (e.c_f > 0) {
        parts.capacitance = static_cast<int>(c.capacitors.size());
        c.capacitors.push_back({parts.node, kEarth, all(e.c_f)});
        terms.push_back({CurrentTerm::Kind::capacitor, parts.capacitance, 1});
    }
    solver_.rebuild();
}

bool EmtEngine::set_source(Setting const& setting, double value) {
    std::size_t const i = index_of(network_.sources, setting.element);
    if (setting.kind->section != "sources" || i == network_.sources.size()) {
        return false;
    }
    auto const source = static_cast<std::size_t>(parts_.sources[i].source);
    if (setting.quantity->name == "voltage_pu") {
        std::size_t const bus = index_of(network_.buses, network_.sources[i].bus.name);
        solver_.set_source_amplitude(source, value * parts_.bus_peak_v[bus]);
        return true;
    }
    if (value * options_.time_base.seconds(options_.step) * kMinStepsPerPeriod > 1) {
        return false;
    }
    solver_.set_source_frequency(source, value);
    return true;
}

bool EmtEngine::set_generator(Setting const& setting, double value) {
    std::size_t const i = index_of(network_.generators, setting.element);
    if (setting.kind->section != "generators" || i == network_.generators.size()) {
        return false;
    }
    NetworkCircuit::GeneratorParts const& parts = parts_.generators[i];
    if (parts.injection >= 0) {
        return parts_.injections[static_cast<std::size_t>(parts.injection)].model->set(setting.quantity->name, value);
    }
    if (setting.quantity->name != "voltage_setpoint_pu") {
        return false; // it gives what the network needs
    }
    std::size_t const bus = index_of(network_.buses, network_.generators[i].bus.name);
    solver_.set_source_amplitude(static_cast<std::size_t>(parts.source), value * parts_.bus_peak_v[bus]);
    return true;
}

bool EmtEngine::set_machine(Setting const& setting, double value) {
    std::size_t const i = index_of(network_.machines, setting.element);
    if (setting.kind->section != "machines" || i == network_.machines.size()) {
        return false;
    }
    EmtMachine& m = solver_.machines()[i];
    Machine& data = network_.machines[i];
    if (setting.quantity->name == "p_kw") {
        m.setpoints().p_ref += (value - data.p_kw) / data.rating_kva;
        data.p_kw = value;
    } else if (setting.quantity->name == "voltage_setpoint_pu") {
        m.setpoints().v_ref += value - data.voltage_setpoint_pu;
        data.voltage_setpoint_pu = value;
    } else if (m.data().governor) {
        m.data().governor->droop_percent = value;
    } else {
        return false;
    }
    return true;
}

/// What is seen from its `from` side goes with the turns there: currents, capacitance and magnetising inductance.
bool EmtEngine::set_transformer(Setting const& setting, double value) {
    std::size_t const i = index_of(network_.transformers, setting.element);
    if (setting.kind->section != "transformers" || i == network_.transformers.size() ||
        network_.transformers[i].saturation) {
        return false;
    }
    NetworkCircuit::TransformerParts const& parts = parts_.transformers[i];
    double const fewer = network_.transformers[i].tap_ratio / value, square = fewer * fewer;
    Circuit& c = solver_.circuit();
    auto const limbs = static_cast<std::size_t>(parts.limbs);
    for (std::size_t k = limbs; k < limbs + 3; ++k) {
        c.windings[k].weights[0] *= fewer;
        c.windings[k].weights[1] *= fewer;
    }
    for (CurrentTerm& term : c.switches[static_cast<std::size_t>(parts.from_switch)].terms) {
        auto const index = static_cast<std::size_t>(term.index);
        if (term.kind == CurrentTerm::Kind::capacitor) {
            PhaseMatrix& farad = c.capacitors[index].c;
            farad = PhaseMatrix::sequence(farad.one * square, farad.zero() * square);
        } else if (term.kind == CurrentTerm::Kind::winding && index == limbs) {
            term.sign *= fewer;
        } else if (term.kind == CurrentTerm::Kind::winding && term.sign > 0) { // magnetising, once
            for (std::size_t k = index; k < index + 3; ++k) {
                c.windings[k].l /= square;
            }
        }
    }
    network_.transformers[i].tap_ratio = value;
    solver_.rebuild();
    return true;
}

Result<void> EmtEngine::act(SetParameter const& a) {
    auto const setting = setting_of(a, true);
    if (!setting) {
        return std::unexpected{setting.error()};
    }
    auto const set = set_one_port(*setting, a.value);
    if (!set) {
        return std::unexpected{set.error()};
    }
    bool const done = *set || set_source(*setting, a.value) || set_generator(*setting, a.value) ||
                      set_machine(*setting, a.value) || set_transformer(*setting, a.value);
    return done ? Result<void>{} : std::unexpected{cannot_be_set(a, true)};
}

} // namespace gridspace::sim::emt
