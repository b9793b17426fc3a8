// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

/// Quantities that are set while a simulation runs.
namespace gridspace::sim::emt {

Result<bool> EmtEngine::set_one_port(Setting const& setting, double value) {
    auto const it =
        std::find_if(one_ports_.begin(), one_ports_.end(), [&](OnePort const* e) { return setting.names(*e); });
    if (it == one_ports_.end()) {
        return false;
    }
    OnePort& found = **it;
    Quantity const& quantity = *setting.quantity;
    if (auto const refusal = found.refuses(quantity.name, NetworkAround{network_}, true)) {
        return fail(ExitCode::usage,
                    fmt::format("'{}.{}.{}' cannot be set: {}", setting.kind->section, setting.element, quantity.name,
                                refusal->why),
                    std::string{refusal->hint});
    }
    auto const index = static_cast<std::size_t>(it - one_ports_.begin());
    if (!found.set(quantity.name, value) || !set_in_parts(parts_.one_ports[index], quantity, value)) {
        return false;
    }
    change_star(index);
    return true;
}

bool EmtEngine::set_in_parts(NetworkCircuit::OnePortParts const& parts, Quantity const& quantity, double value) {
    if (PowerModel* model = model_of(parts); model != nullptr && !model->set(quantity.name, value)) {
        return false;
    }
    if (parts.norton >= 0 &&
        !solver_.circuit().norton[static_cast<std::size_t>(parts.norton)].element->set(quantity.name, value)) {
        return false;
    }
    if (parts.source < 0) {
        return true;
    }
    auto const source = static_cast<std::size_t>(parts.source);
    if (!quantity.turns_voltages) {
        solver_.set_source_amplitude(source, value * parts_.bus_peak_v[parts.bus]);
        return true;
    }
    if (value * options_.time_base.seconds(options_.step) * kMinStepsPerPeriod > 1) {
        return false;
    }
    solver_.set_source_frequency(source, value);
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
    change_inductance(parts, e.l_h);
    if (parts.capacitance >= 0) {
        c.capacitors[static_cast<std::size_t>(parts.capacitance)].c = all(e.c_f);
    } else if (e.c_f > 0) {
        parts.capacitance = static_cast<int>(c.capacitors.size());
        c.capacitors.push_back({parts.node, kEarth, all(e.c_f)});
        terms.push_back({CurrentTerm::Kind::capacitor, parts.capacitance, 1});
        solver_.start_capacitor(parts.capacitance, parts.resistance);
    }
    solver_.rebuild();
}

/// The flux of a steady state, v / (j w), does not depend on the inductance: what keeps it has its new current at once,
/// and no direct current, which would last for L / R of the network behind.
void EmtEngine::change_inductance(NetworkCircuit::OnePortParts& parts, double l_h) {
    Circuit& c = solver_.circuit();
    PhaseMatrix const l = PhaseMatrix::sequence(l_h, l_h);
    if (parts.inductance >= 0) {
        double const before_h = std::exchange(c.rl[static_cast<std::size_t>(parts.inductance)].l, l).one;
        if (before_h < kNothing || l_h >= kNothing) {
            solver_.keep_flux(parts.inductance, before_h, l_h);
        } else { // the flux of what conducted nothing may be from before an outage
            solver_.start_inductor(parts.inductance, parts.resistance);
        }
    } else if (l_h < kNothing) {
        parts.inductance = static_cast<int>(c.rl.size());
        c.rl.push_back({parts.node, kEarth, {}, l});
        c.switches[static_cast<std::size_t>(parts.breaker)].terms.push_back(
            {CurrentTerm::Kind::rl, parts.inductance, 1});
        solver_.start_inductor(parts.inductance, parts.resistance);
    }
}

bool EmtEngine::set_two_port(Setting const& setting, double value) {
    for (std::size_t i = 0; i < two_ports_.size(); ++i) {
        if (setting.names(*two_ports_[i]) &&
            two_ports_[i]->set_in_circuit(solver_.circuit(), parts_.two_ports[i], setting.quantity->name, value)) {
            solver_.rebuild();
            return true;
        }
    }
    return false;
}

Result<void> EmtEngine::act(SetMode const& a) {
    if (auto ok = check_mode(network_, a); !ok) {
        return ok;
    }
    std::size_t const i = one_port_named(a.element);
    if (int const norton = i < one_ports_.size() ? parts_.one_ports[i].norton : -1; norton >= 0) {
        solver_.circuit().norton[static_cast<std::size_t>(norton)].element->set_mode(a.mode);
    }
    return {};
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
    return *set || set_two_port(*setting, a.value) ? Result<void>{} : std::unexpected{cannot_be_set(a, true)};
}

} // namespace gridspace::sim::emt
