// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <cmath>
#include <limits>
#include <numbers>

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
    branch_signals();
    unit_signals();
    one_port_signals();
    source_signals();
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

void EmtEngine::branch_signals() {
    auto const end = [&](std::string const& prefix, std::size_t bus, int index) {
        auto const s = static_cast<std::size_t>(index);
        phases(prefix + ".i", "A", [this, s](int k) { return solver_.switch_current(s, k); });
        signal(prefix + ".i_a", "A", [this, s] { return length(switch_space(s)) / std::numbers::sqrt2; });
        signal(prefix + ".p_kw", "kW", [this, bus, s] { return switch_power(bus, s).real(); });
        signal(prefix + ".q_kvar", "kvar", [this, bus, s] { return switch_power(bus, s).imag(); });
    };
    for (std::size_t i = 0; i < network_.lines.size(); ++i) {
        Line const& line = network_.lines[i];
        end("line." + line.name.name + ".from", index_of(network_.buses, line.from.name), parts_.lines[i].from_switch);
        end("line." + line.name.name + ".to", index_of(network_.buses, line.to.name), parts_.lines[i].to_switch);
    }
    for (std::size_t i = 0; i < parts_.transformers.size(); ++i) {
        Transformer const& t = network_.transformers[i];
        end("transformer." + t.name.name + ".from", index_of(network_.buses, t.from.name),
            parts_.transformers[i].from_switch);
        end("transformer." + t.name.name + ".to", index_of(network_.buses, t.to.name),
            parts_.transformers[i].to_switch);
    }
    for (std::size_t i = 0; i < network_.breakers.size(); ++i) {
        std::string const prefix = "breaker." + network_.breakers[i].name.name;
        auto const s = static_cast<std::size_t>(parts_.breaker_switch[i]);
        position_signal(prefix, parts_.breaker_switch[i]);
        phases(prefix + ".pole", "dpc", [this, s](int k) { return solver_.pole_closed(s, k) ? kClosed : kOpen; });
        signal(prefix + ".opened_s", "s", [this, s] { return solver_.opened_at(s); });
        signals_.back().may_be_unknown = true;
    }
    auto const instrument = [&](std::string const& prefix, std::string const& quantity, std::string const& unit,
                                std::size_t i, bool saturates) {
        phases(prefix + quantity, unit, [this, i](int k) {
            Instrument const& sensor = instruments_[i];
            auto const phase = static_cast<std::size_t>(k);
            if (sensor.transformer.dynamic()) {
                return sensor.transformer.value(phase);
            }
            return sensor.transformer.shown(sensor.current ? solver_.switch_current(sensor.at, k)
                                                           : solver_.node_voltage(static_cast<int>(sensor.at) + k));
        });
        if (saturates) {
            phases(prefix + ".flux_pu", "p.u.",
                   [this, i](int k) { return instruments_[i].transformer.flux_pu(static_cast<std::size_t>(k)); });
        }
    };
    std::size_t next = 0;
    for (Ct const& ct : network_.cts) {
        instrument("ct." + ct.name.name, ".i", "A", next++,
                   find(network_.ct_types, ct.type.name)->saturation.has_value());
    }
    for (Vt const& vt : network_.vts) {
        instrument("vt." + vt.name.name, ".v", "V", next++,
                   find(network_.vt_types, vt.type.name)->saturation.has_value());
    }
}

void EmtEngine::unit_signals() {
    for (std::size_t i = 0; i < network_.machines.size(); ++i) {
        std::string const prefix = "machine." + network_.machines[i].name.name;
        auto const machine = [this, i]() -> EmtMachine const& { return solver_.machines()[i]; };
        auto const state = [this, i](std::size_t s) { return solver_.machines()[i].state()[s]; };
        double const rating = network_.machines[i].rating_kva;
        signal(prefix + ".frequency_hz", "Hz", [machine] { return machine().frequency_hz(); });
        signal(prefix + ".speed_pu", "p.u.", [state] { return 1 + state(machines::kSpeed); });
        signal(prefix + ".angle_deg", "deg", [state] { return state(machines::kAngle) * kDegrees; });
        signal(prefix + ".torque_pu", "p.u.", [machine] { return machine().torque_pu(); });
        signal(prefix + ".v_pu", "p.u.", [machine] { return machine().voltage_pu(); });
        signal(prefix + ".efd_pu", "p.u.", [state] { return state(machines::kEfd); });
        signal(prefix + ".p_kw", "kW", [machine, rating] { return machine().power_pu().real() * rating; });
        signal(prefix + ".q_kvar", "kvar", [machine, rating] { return machine().power_pu().imag() * rating; });
        signal(prefix + ".mechanical_kw", "kW", [machine, state, rating] {
            return (machine().data().governor ? state(machines::kPower) : state(machines::kGate)) * rating;
        });
        phases(prefix + ".i", "A", [machine](int k) { return machine().current_a(k); });
    }
    if (!network_.machines.empty()) {
        signal("system.coi_hz", "Hz", [this] {
            double weighted = 0, weight = 0;
            for (EmtMachine const& m : solver_.machines()) {
                weighted += m.data().h * m.data().rating_kva * m.frequency_hz();
                weight += m.data().h * m.data().rating_kva;
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
        std::string const prefix = std::string{kind.prefix} + "." + one_ports_[i]->name.name;
        if (kind.has_signals) {
            powers_and_currents(prefix, parts.bus, parts.breaker, kind.feeds ? -1 : 1);
        }
        if (kind.switched) {
            position_signal(prefix, parts.breaker);
        }
        if (parts.injection >= 0) {
            PowerModel const* model = parts_.injections[static_cast<std::size_t>(parts.injection)].model.get();
            std::vector<SignalDef> const own = model->signals();
            for (std::size_t k = 0; k < own.size(); ++k) {
                signal(prefix + "." + own[k].name, own[k].unit, [model, k] { return model->value(k); });
            }
        }
    }
}

void EmtEngine::source_signals() {
    // An ideal source gives what everything else at its bus takes.
    auto const rest_of_bus = [this](std::size_t bus, std::size_t own, int k) {
        int const node = parts_.bus_node[bus];
        double sum = 0;
        Circuit const& c = solver_.circuit();
        for (std::size_t s = 0; s < c.switches.size(); ++s) {
            sum += s != own && c.switches[s].outer == node ? solver_.switch_current(s, k) : 0;
        }
        for (std::size_t f = 0; f < c.faults.size(); ++f) {
            sum += c.faults[f].node == node ? solver_.fault_current(f, k) : 0;
        }
        return sum;
    };
    auto const ideal = [&](std::string const& prefix, Ref const& bus_ref, int breaker) {
        std::size_t const bus = index_of(network_.buses, bus_ref.name);
        auto const own = static_cast<std::size_t>(breaker);
        auto const power = [this, bus, own, rest_of_bus]() -> std::complex<double> {
            Space const i = to_space(rest_of_bus(bus, own, 0), rest_of_bus(bus, own, 1), rest_of_bus(bus, own, 2));
            Space const v = bus_voltage(bus);
            return {1.5e-3 * (v.alpha * i.alpha + v.beta * i.beta + 2 * v.zero * i.zero),
                    1.5e-3 * (v.beta * i.alpha - v.alpha * i.beta)};
        };
        auto const closed = [this, own] { return solver_.pole_closed(own, 0) ? 1.0 : 0.0; };
        signal(prefix + ".p_kw", "kW", [power, closed] { return closed() * power().real(); });
        signal(prefix + ".q_kvar", "kvar", [power, closed] { return closed() * power().imag(); });
        phases(prefix + ".i", "A",
               [bus, own, rest_of_bus, closed](int k) { return closed() * rest_of_bus(bus, own, k); });
    };
    for (std::size_t i = 0; i < network_.sources.size(); ++i) {
        std::string const prefix = "source." + network_.sources[i].name.name;
        if (parts_.sources[i].impedance >= 0) {
            powers_and_currents(prefix, index_of(network_.buses, network_.sources[i].bus.name),
                                parts_.sources[i].breaker, -1);
        } else {
            ideal(prefix, network_.sources[i].bus, parts_.sources[i].breaker);
        }
    }
    for (std::size_t g = 0; g < network_.generators.size(); ++g) {
        std::string const prefix = "generator." + network_.generators[g].name.name;
        Ref const& bus = network_.generators[g].bus;
        if (parts_.generators[g].injection < 0) {
            ideal(prefix, bus, parts_.generators[g].breaker);
        } else {
            powers_and_currents(prefix, index_of(network_.buses, bus.name), parts_.generators[g].breaker, -1);
        }
    }
}

} // namespace gridspace::sim::emt
