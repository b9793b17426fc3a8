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
        signal(bus + ".frequency_hz", "Hz", [this, i] { return plls_[i].frequency_hz(); });
        signal("pll." + name + ".hz", "Hz", [this, i] { return plls_[i].frequency_hz(); });
    }
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
        signal(prefix + ".position", "dpc", [this, s] {
            int closed = 0;
            for (int k = 0; k < 3; ++k) {
                closed += solver_.pole_closed(s, k) ? 1 : 0;
            }
            return closed == 0 ? kOpen : closed == 3 && !solver_.opening(s) ? kClosed : kIntermediate;
        });
        phases(prefix + ".pole", "dpc", [this, s](int k) { return solver_.pole_closed(s, k) ? kClosed : kOpen; });
        signal(prefix + ".opened_s", "s", [this, s] { return solver_.opened_at(s); });
    }
    for (Ct const& ct : network_.cts) {
        CtType const& type = *find(network_.ct_types, ct.type.name);
        NetworkCircuit::LineParts const& line = parts_.lines[index_of(network_.lines, ct.line.name)];
        CtReading reading;
        bool const at_from = ct.end == LineEnd::from;
        reading.switch_index = static_cast<std::size_t>(at_from ? line.from_switch : line.to_switch);
        reading.factor = (at_from || ct.positive == CtPolarity::into_line ? 1 : -1) * (1 + type.error_percent / 100);
        reading.quantum_a = type.quantum_ma * 1e-3;
        phases("ct." + ct.name.name + ".i", "A", [this, reading](int k) { return ct_current(reading, k); });
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
    auto const consumer = [&](std::string const& prefix, Ref const& bus_ref, int index, double sign) {
        std::size_t const bus = index_of(network_.buses, bus_ref.name);
        auto const s = static_cast<std::size_t>(index);
        signal(prefix + ".p_kw", "kW", [this, bus, s, sign] { return sign * switch_power(bus, s).real(); });
        signal(prefix + ".q_kvar", "kvar", [this, bus, s, sign] { return sign * switch_power(bus, s).imag(); });
        phases(prefix + ".i", "A", [this, s, sign](int k) { return sign * solver_.switch_current(s, k); });
    };
    for (std::size_t i = 0; i < network_.loads.size(); ++i) {
        consumer("load." + network_.loads[i].name.name, network_.loads[i].bus, parts_.loads[i].breaker, 1);
    }
    for (NetworkCircuit::Follower const& f : parts_.followers) {
        if (f.kind == NetworkCircuit::Follower::Kind::pv) {
            consumer("pv." + network_.pv[f.element].name.name, network_.pv[f.element].bus, f.breaker, -1);
        } else if (f.kind == NetworkCircuit::Follower::Kind::generator) {
            consumer("generator." + network_.generators[f.element].name.name, network_.generators[f.element].bus,
                     f.breaker, -1);
        }
    }
    for (std::size_t i = 0; i < network_.sources.size(); ++i) {
        if (parts_.sources[i].impedance >= 0) {
            consumer("source." + network_.sources[i].name.name, network_.sources[i].bus, parts_.sources[i].breaker, -1);
        }
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

} // namespace gridspace::sim::emt
