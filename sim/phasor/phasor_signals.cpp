// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim::phasor {
namespace {

/// Double-point values of IEC 61850-7-3: intermediate 0, off 1, on 2, bad 3.
constexpr double kIntermediate = 0, kOpen = 1, kClosed = 2;

} // namespace

void PhasorEngine::define_signals() {
    define_bus_signals();
    define_branch_signals();
    for (std::size_t i = 0; i < network_.breakers.size(); ++i) {
        signal("breaker." + network_.breakers[i].name.name + ".position", "dpc", [this, i] {
            return opening(i) ? kIntermediate : switches_.breaker_closed[i] ? kClosed : kOpen;
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
    for (auto const& [name, unit] : units_) {
        if (unit.kind != nullptr && unit.kind->switched) {
            signal(fmt::format("{}.{}.position", unit.kind->prefix, name), "dpc",
                   [injection = unit.injection] { return injection->connected() ? kClosed : kOpen; });
        }
    }
    if (!machines_.empty()) {
        signal("system.coi_hz", "Hz", [this] {
            double weighted = 0, weight = 0;
            for (MachineInjection const* m : machines_) {
                auto const x = dae_->states_of(index_of_injection(m), std::span<double const>{y_});
                double const inertia = m->data().h * m->data().rating_kva;
                weighted += inertia * m->value(0, t_, x, dae_->voltage(m->bus(), y_));
                weight += inertia;
            }
            return weighted / weight;
        });
    }
    define_generator_signals();
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
    auto const branch_signals = [&](TwoPort::Kind kind, std::string const& prefix, std::size_t element,
                                    double amperes_from, double amperes_to) {
        for (bool const from : {true, false}) {
            auto const current = [this, kind, element, from]() -> std::pair<Complex, Complex> {
                for (TwoPort const& b : branches_) {
                    if (b.kind == kind && b.element == element) {
                        Complex const vf = dae_->voltage(b.from, y_), vt = dae_->voltage(b.to, y_);
                        return from ? std::pair{vf, b.ff * vf + b.ft * vt} : std::pair{vt, b.tf * vf + b.tt * vt};
                    }
                }
                return {};
            };
            std::string const end = prefix + (from ? ".from" : ".to");
            double const amperes = from ? amperes_from : amperes_to;
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
    };
    auto const amperes = [&](Ref const& bus) {
        return base * 1e3 / (std::sqrt(3.0) * network_.buses[bus_of(bus)].voltage_v);
    };
    for (std::size_t i = 0; i < network_.lines.size(); ++i) {
        Line const& line = network_.lines[i];
        branch_signals(TwoPort::Kind::line, "line." + line.name.name, i, amperes(line.from), amperes(line.to));
    }
    for (std::size_t i = 0; i < network_.transformers.size(); ++i) {
        Transformer const& t = network_.transformers[i];
        branch_signals(TwoPort::Kind::transformer, "transformer." + t.name.name, i, amperes(t.from), amperes(t.to));
    }
}

void PhasorEngine::define_generator_signals() {
    double const base = network_.power_kva;
    for (Generator const& g : network_.generators) {
        if (g.role != GeneratorRole::pq) {
            // What the bus needs beyond its other injections; shared equally where several hold one bus.
            std::size_t const bus = bus_of(g.bus);
            auto const holders = static_cast<double>(
                std::count_if(network_.generators.begin(), network_.generators.end(), [&](Generator const& other) {
                    return other.role != GeneratorRole::pq && other.bus == g.bus;
                }));
            auto const power = [this, bus, holders] {
                Complex const v = dae_->voltage(bus, y_);
                return v * std::conj(dae_->network_current(bus, y_) - dae_->injected_current(bus, t_, y_)) / holders;
            };
            signal("generator." + g.name.name + ".p_kw", "kW", [power, base] { return power().real() * base; });
            signal("generator." + g.name.name + ".q_kvar", "kvar", [power, base] { return power().imag() * base; });
        }
    }
}

std::vector<SignalDef> phasor_signals(Network const& network) {
    return PhasorEngine{network, {}}.signals();
}

} // namespace gridspace::sim::phasor
