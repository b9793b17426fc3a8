// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <algorithm>
#include <numbers>

/// Currents that follow the voltage: converters, and loads that are not constant impedances.
namespace gridspace::sim::emt {

std::complex<double> EmtEngine::wanted(std::size_t i, double t, double v, double h) {
    NetworkCircuit::Injection const& injection = parts_.injections[i];
    // What its filter gives, a converter takes back.
    std::complex<double> const filter{0, 1e3 * injection.filter_kvar * v * v};
    return injection.model->power_va(t, v, h) - filter;
}

std::vector<EmtEngine::BusPhases> EmtEngine::start_injections(std::vector<BusPhases> const& bus_v,
                                                              std::vector<double> const& kvar) {
    converters_.clear();
    phase_currents_.clear();
    for (std::size_t i = 0; i < parts_.one_ports.size(); ++i) {
        if (PowerModel* model = model_of(parts_.one_ports[i])) {
            model->start(kvar[i]);
        }
    }
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    std::vector<BusPhases> currents;
    for (std::size_t i = 0; i < parts_.injections.size(); ++i) {
        NetworkCircuit::Injection const& injection = parts_.injections[i];
        double const peak = parts_.bus_peak_v[injection.bus];
        BusPhases v = bus_v[injection.bus];
        converters_.emplace_back(network_.frequency_hz, peak, injection.max_peak_a, injection.rules);
        phase_currents_.emplace_back(network_.frequency_hz, peak);
        if (injection.by_phase) {
            PhaseFollowing::Powers power;
            for (std::size_t k = 0; k < 3; ++k) {
                power[k] = injection.model->phase_power_va(k, 0, std::abs(v[k]), 0);
                v[k] *= peak;
            }
            currents.push_back(phase_currents_.back().start(v, power));
            continue;
        }
        std::complex<double> const one = (v[0] + turn * v[1] + turn * turn * v[2]) / 3.0;
        std::complex<double> const power = wanted(i, 0, std::abs(one), 0);
        std::complex<double> const a = converters_.back().start(one * peak, power);
        currents.push_back({a, a / turn, a * turn});
    }
    return currents;
}

void EmtEngine::inject(Range injections, double h) {
    for (std::size_t f = injections.begin; f < injections.end; ++f) {
        auto const i = parts_.injections[f].by_phase ? phase_currents_[f].currents(h) : converters_[f].currents(h);
        std::copy(i.begin(), i.end(), solver_.injected().begin() + static_cast<std::ptrdiff_t>(3 * f));
    }
}

void EmtEngine::step_injections(Range injections, double t_end, double h) {
    for (std::size_t i = injections.begin; i < injections.end; ++i) {
        if (converters_[i].tripped()) {
            continue; // out of service: nothing measures, charges or ages
        }
        NetworkCircuit::Injection const& injection = parts_.injections[i];
        double const a = solver_.node_voltage(injection.node), b = solver_.node_voltage(injection.node + 1),
                     c = solver_.node_voltage(injection.node + 2);
        if (injection.by_phase) {
            PhaseFollowing::Powers power;
            for (std::size_t k = 0; k < 3; ++k) {
                power[k] = injection.model->phase_power_va(k, t_end, phase_currents_[i].voltage_pu(k), h);
            }
            phase_currents_[i].step({a, b, c}, power, h);
        } else {
            // One that has ceased regulates and ages nothing.
            std::complex<double> power;
            if (converters_[i].ceased()) {
                injection.model->disconnect();
            } else {
                power = wanted(i, t_end, converters_[i].voltage_pu(), h);
            }
            converters_[i].step(to_space(a, b, c), power, h);
        }
    }
}

} // namespace gridspace::sim::emt
