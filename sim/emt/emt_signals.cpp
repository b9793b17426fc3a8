// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

/// What can be read of a waveform simulation. Values belong to the present instant; `_pu`, `_a` and powers of
/// alternating quantities are those of the instantaneous space vector (equal to r.m.s. values in a balanced steady
/// state).
namespace gridspace::sim::emt {
namespace {

/// Double-point values of IEC 61850-7-3: intermediate 0, off 1, on 2, bad 3.
constexpr double kIntermediate = 0, kOpen = 1, kClosed = 2;
constexpr double kDegrees = 180 / std::numbers::pi;

double length(Space const& s) {
    return std::sqrt(s.alpha * s.alpha + s.beta * s.beta);
}

} // namespace

void EmtEngine::signal(std::string name, std::string unit, std::function<double()> read) {
    signals_.push_back({std::move(name), std::move(unit)});
    readers_.push_back(std::move(read));
}

void EmtEngine::phases(std::string const& prefix, std::string const& unit, std::function<double(int)> read) {
    for (int k = 0; k < 3; ++k) {
        signal(prefix + "." + "abc"[k], unit, [read, k] { return read(k); });
    }
}

void EmtEngine::define_signals() {
    bus_signals();
    two_port_signals();
    switch_signals();
    instrument_signals();
    one_port_signals();
    rotor_signals();
}

void EmtEngine::bus_signals() {
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        std::string const& name = network_.buses[i].name.name;
        std::string const bus = "bus." + name;
        int const node = parts_.bus_node[i];
        phases(bus + ".v", "V", [this, node](int k) { return solver_.node_voltage(node + k); });
        signal(bus + ".v_pu", "p.u.", [this, i] { return length(bus_voltage(i)) / parts_.bus_peak_v[i]; });
        signal(bus + ".angle_deg", "deg", [this, i] {
            Space const v = bus_voltage(i);
            double const turned =
                std::fmod(2 * std::numbers::pi * network_.frequency_hz * solver_.t(), 2 * std::numbers::pi);
            return std::remainder(std::atan2(v.beta, v.alpha) - turned, 2 * std::numbers::pi) * kDegrees;
        });
        for (std::string const& loop : {bus + ".frequency_hz", "pll." + name + ".hz"}) {
            pll_signals_.emplace_back(signals_.size(), i);
            signal(loop, "Hz", [this, i] { return plls_[i].frequency_hz(); });
        }
    }
}

void EmtEngine::position_signal(std::string const& prefix, int breaker) {
    auto const s = static_cast<std::size_t>(breaker);
    signal(prefix + ".position", "dpc", [this, s] {
        int closed = 0;
        for (int k = 0; k < 3; ++k) {
            closed += solver_.pole_closed(s, k) ? 1 : 0;
        }
        return closed == 0 ? kOpen : closed == 3 && !solver_.opening(s) ? kClosed : kIntermediate;
    });
}

void EmtEngine::two_port_signals() {
    auto const end = [&](std::string const& prefix, Ref const& bus_ref, int index) {
        auto const s = static_cast<std::size_t>(index);
        std::size_t const bus = index_of(network_.buses, bus_ref.name);
        phases(prefix + ".i", "A", [this, s](int k) { return solver_.switch_current(s, k); });
        signal(prefix + ".i_a", "A", [this, s] { return length(switch_space(s)) / std::numbers::sqrt2; });
        signal(prefix + ".p_kw", "kW", [this, bus, s] { return switch_power(bus, s).real(); });
        signal(prefix + ".q_kvar", "kvar", [this, bus, s] { return switch_power(bus, s).imag(); });
    };
    for (std::size_t i = 0; i < two_ports_.size(); ++i) {
        TwoPort const& e = *two_ports_[i];
        std::string const prefix = signal_prefix(e);
        end(prefix + ".from", e.from, parts_.two_ports[i].from_switch);
        end(prefix + ".to", e.to, parts_.two_ports[i].to_switch);
    }
}

void EmtEngine::switch_signals() {
    std::vector<LineSwitch const*> const at_lines = all<LineSwitch>(std::as_const(network_));
    for (std::size_t i = 0; i < at_lines.size(); ++i) {
        std::string const prefix = signal_prefix(*at_lines[i]);
        auto const s = static_cast<std::size_t>(parts_.line_switch[i]);
        position_signal(prefix, parts_.line_switch[i]);
        phases(prefix + ".pole", "dpc", [this, s](int k) { return solver_.pole_closed(s, k) ? kClosed : kOpen; });
        signal(prefix + ".opened_s", "s", [this, s] { return solver_.opened_at(s); });
        signals_.back().may_be_unknown = true;
    }
}

void EmtEngine::instrument_signals() {
    std::vector<Instrument const*> const elements = all<Instrument>(std::as_const(network_));
    for (std::size_t i = 0; i < elements.size(); ++i) {
        std::string const prefix = signal_prefix(*elements[i]);
        bool const current = instruments_[i].current;
        phases(prefix + (current ? ".i" : ".v"), current ? "A" : "V", [this, i](int k) {
            MeteredPlace const& sensor = instruments_[i];
            auto const phase = static_cast<std::size_t>(k);
            if (sensor.transformer.dynamic()) {
                return sensor.transformer.value(phase);
            }
            return sensor.transformer.shown(sensor.current ? solver_.switch_current(sensor.at, k)
                                                           : solver_.node_voltage(static_cast<int>(sensor.at) + k));
        });
        if (instruments_[i].transformer.saturates()) {
            phases(prefix + ".flux_pu", "p.u.",
                   [this, i](int k) { return instruments_[i].transformer.flux_pu(static_cast<std::size_t>(k)); });
        }
    }
}

void EmtEngine::rotor_signals() {
    std::vector<NortonElement const*> turning;
    for (NortonPort const& p : solver_.circuit().norton) {
        if (p.element->rotor()) {
            turning.push_back(p.element.get());
        }
    }
    if (!turning.empty()) {
        signal("system.coi_hz", "Hz", [turning] {
            double weighted = 0, weight = 0;
            for (NortonElement const* e : turning) {
                Rotor const r = *e->rotor();
                weighted += r.inertia_kws * r.frequency_hz;
                weight += r.inertia_kws;
            }
            return weighted / weight;
        });
    }
}

void EmtEngine::powers_and_currents(std::string const& prefix, std::size_t bus, int breaker, double sign) {
    auto const s = static_cast<std::size_t>(breaker);
    signal(prefix + ".p_kw", "kW", [this, bus, s, sign] { return sign * switch_power(bus, s).real(); });
    signal(prefix + ".q_kvar", "kvar", [this, bus, s, sign] { return sign * switch_power(bus, s).imag(); });
    phases(prefix + ".i", "A", [this, s, sign](int k) { return sign * solver_.switch_current(s, k); });
}

void EmtEngine::one_port_signals() {
    for (std::size_t i = 0; i < one_ports_.size(); ++i) {
        Kind const& kind = one_ports_[i]->kind();
        NetworkCircuit::OnePortParts const& parts = parts_.one_ports[i];
        std::string const prefix = signal_prefix(*one_ports_[i]);
        if (parts.source >= 0 && parts.impedance < 0) {
            ideal_source_signals(prefix, parts);
        } else if (kind.has_signals) {
            powers_and_currents(prefix, parts.bus, parts.breaker, kind.feeds ? -1 : 1);
        }
        if (kind.follows(Command::open)) {
            position_signal(prefix, parts.breaker);
        }
        auto const add = [&](auto const* model) {
            std::vector<SignalDef> const own = model->signals();
            for (std::size_t k = 0; k < own.size(); ++k) {
                signal(prefix + "." + own[k].name, own[k].unit, [model, k] { return model->value(k); });
            }
        };
        if (PowerModel const* model = model_of(parts)) {
            add(model);
            auto const injection = static_cast<std::size_t>(parts.injection);
            if (parts_.injections[injection].shows_share) {
                signal(prefix + ".in_service_share", "p.u.",
                       [this, injection] { return converters_[injection].share(); });
            }
        }
        if (parts.norton >= 0) {
            add(static_cast<NortonElement const*>(
                solver_.circuit().norton[static_cast<std::size_t>(parts.norton)].element.get()));
        }
    }
}

double EmtEngine::rest_of_bus(std::size_t bus, std::size_t own_switch, int phase) const {
    int const node = parts_.bus_node[bus];
    double sum = 0;
    Circuit const& c = solver_.circuit();
    for (std::size_t s = 0; s < c.switches.size(); ++s) {
        sum += s != own_switch && c.switches[s].outer == node ? solver_.switch_current(s, phase) : 0;
    }
    for (std::size_t f = 0; f < c.faults.size(); ++f) {
        sum += c.faults[f].node == node ? solver_.fault_current(f, phase) : 0;
    }
    return sum;
}

void EmtEngine::ideal_source_signals(std::string const& prefix, NetworkCircuit::OnePortParts const& parts) {
    auto const own = static_cast<std::size_t>(parts.breaker);
    auto const power = [this, bus = parts.bus, own]() -> std::complex<double> {
        Space const i = to_space(rest_of_bus(bus, own, 0), rest_of_bus(bus, own, 1), rest_of_bus(bus, own, 2));
        Space const v = bus_voltage(bus);
        return {1.5e-3 * (v.alpha * i.alpha + v.beta * i.beta + 2 * v.zero * i.zero),
                1.5e-3 * (v.beta * i.alpha - v.alpha * i.beta)};
    };
    auto const closed = [this, own] { return solver_.pole_closed(own, 0) ? 1.0 : 0.0; };
    signal(prefix + ".p_kw", "kW", [power, closed] { return closed() * power().real(); });
    signal(prefix + ".q_kvar", "kvar", [power, closed] { return closed() * power().imag(); });
    phases(prefix + ".i", "A",
           [this, bus = parts.bus, own, closed](int k) { return closed() * rest_of_bus(bus, own, k); });
}

} // namespace gridspace::sim::emt
