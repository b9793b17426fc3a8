// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gridspace::sim::phasor {
namespace {

/// Double-point values of IEC 61850-7-3: intermediate 0, off 1, on 2, bad 3.
constexpr double kIntermediate = 0, kOpen = 1, kClosed = 2;

} // namespace

void PhasorEngine::define_signals() {
    define_bus_signals();
    define_branch_signals();
    std::vector<LineSwitch const*> const at_lines = all<LineSwitch>(std::as_const(network_));
    for (std::size_t i = 0; i < at_lines.size(); ++i) {
        signal(signal_prefix(*at_lines[i]) + ".position", "dpc", [this, i] {
            return opening(i) ? kIntermediate : switches_.switch_closed[i] ? kClosed : kOpen;
        });
    }
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        std::vector<SignalDef> const own = injections_[k]->signals();
        for (std::size_t s = 0; s < own.size(); ++s) {
            signal(own[s].name, own[s].unit, [this, k, s] {
                return injections_[k]->value(s, t_, dae_->states_of(k, std::span<double const>{y_}),
                                             dae_->voltage(injections_[k]->bus(), y_));
            });
        }
    }
    for (Unit const& unit : units_) {
        if (unit.injection && unit.element->kind().follows(Command::open)) {
            signal(signal_prefix(*unit.element) + ".position", "dpc",
                   [this, k = *unit.injection] { return injections_[k]->connected() ? kClosed : kOpen; });
        }
    }
    auto const rotor = [this](std::size_t k) {
        return injections_[k]->rotor(dae_->states_of(k, std::span<double const>{y_}));
    };
    std::vector<std::size_t> turning;
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        if (rotor(k)) {
            turning.push_back(k);
        }
    }
    if (!turning.empty()) {
        signal("system.coi_hz", "Hz", [rotor, turning] {
            double weighted = 0, weight = 0;
            for (std::size_t const k : turning) {
                Rotor const r = *rotor(k);
                weighted += r.inertia_kws * r.frequency_hz;
                weight += r.inertia_kws;
            }
            return weighted / weight;
        });
    }
    define_held_signals();
}

void PhasorEngine::define_bus_signals() {
    double const base = network_.power_kva;
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        std::string const bus = "bus." + network_.buses[i].name.name;
        signal(bus + ".v_pu", "p.u.", [this, i] { return std::abs(dae_->voltage(i, y_)); });
        signal(bus + ".angle_deg", "deg", [this, i] { return std::arg(dae_->voltage(i, y_)) * kDegrees; });
        signal(bus + ".frequency_hz", "Hz", [this, i] { return network_.frequency_hz + slopes_hz_[i]; });
        auto const net = [this, i] { return -dae_->voltage(i, y_) * std::conj(dae_->network_current(i, y_)); };
        signal(bus + ".p_kw", "kW", [net, base] { return net().real() * base; });
        signal(bus + ".q_kvar", "kvar", [net, base] { return net().imag() * base; });
    }
}

void PhasorEngine::define_branch_signals() {
    double const base = network_.power_kva;
    std::vector<TwoPort const*> const elements = two_ports(network_);
    for (std::size_t element = 0; element < elements.size(); ++element) {
        TwoPort const& e = *elements[element];
        for (bool const from : {true, false}) {
            auto const current = [this, element, from]() -> std::pair<Complex, Complex> {
                for (Branch const& b : branches_) {
                    if (b.element == element) {
                        Complex const vf = dae_->voltage(b.from, y_), vt = dae_->voltage(b.to, y_);
                        return from ? std::pair{vf, b.ff * vf + b.ft * vt} : std::pair{vt, b.tf * vf + b.tt * vt};
                    }
                }
                return {};
            };
            std::string const end = signal_prefix(e) + (from ? ".from" : ".to");
            double const amperes =
                base * 1e3 / (std::sqrt(3.0) * network_.buses[bus_of(from ? e.from : e.to)].voltage_v);
            signal(end + ".p_kw", "kW", [current, base] {
                auto const [v, i] = current();
                return (v * std::conj(i)).real() * base;
            });
            signal(end + ".q_kvar", "kvar", [current, base] {
                auto const [v, i] = current();
                return (v * std::conj(i)).imag() * base;
            });
            signal(end + ".i_a", "A", [current, amperes] { return std::abs(current().second) * amperes; });
        }
    }
}

/// What the bus needs beyond its other injections; shared equally where several hold one bus.
void PhasorEngine::define_held_signals() {
    double const base = network_.power_kva;
    for (Unit const& unit : units_) {
        if (!unit.holds_without_injection()) {
            continue;
        }
        std::size_t const bus = bus_of(unit.element->bus);
        auto const holders = static_cast<double>(std::count_if(units_.begin(), units_.end(), [&](Unit const& other) {
            return other.holds_without_injection() && other.element->bus == unit.element->bus;
        }));
        auto const power = [this, bus, holders] {
            Complex const v = dae_->voltage(bus, y_);
            return v * std::conj(dae_->network_current(bus, y_) - dae_->injected_current(bus, t_, y_)) / holders;
        };
        std::string const name = signal_prefix(*unit.element);
        signal(name + ".p_kw", "kW", [power, base] { return power().real() * base; });
        signal(name + ".q_kvar", "kvar", [power, base] { return power().imag() * base; });
    }
}

std::vector<SignalDef> phasor_signals(Network const& network) {
    return PhasorEngine{network, {}}.signals();
}

} // namespace gridspace::sim::phasor
