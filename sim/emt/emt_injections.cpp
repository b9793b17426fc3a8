// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <algorithm>
#include <numbers>

/// Currents that follow the voltage: converters, and loads that are not constant impedances.
namespace gridspace::sim::emt {

std::complex<double> EmtEngine::wanted(Following const& injection, double t, double v, double h) {
    // What its filter gives, a converter takes back.
    std::complex<double> const filter{0, 1e3 * injection.filter_kvar * v * v};
    return injection.model->power_va(t, v, h) - filter;
}

std::vector<EmtEngine::BusPhases> EmtEngine::start_injections(std::vector<BusPhases> const& bus_v,
                                                              std::vector<double> const& kvar) {
    converters_.clear();
    phase_currents_.clear();
    following_.clear();
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
        following_.push_back({injection.node, injection.by_phase, injection.filter_kvar, injection.model.get(), {}});
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
        std::complex<double> const power = wanted(following_.back(), 0, std::abs(one), 0);
        std::complex<double> const a = converters_.back().start(one * peak, power);
        currents.push_back({a, a / turn, a * turn});
    }
    return currents;
}

void EmtEngine::inject(Injections injections, double h) {
    for (int const index : injections) {
        auto const f = static_cast<std::size_t>(index);
        auto const i = following_[f].by_phase ? phase_currents_[f].currents(h) : converters_[f].currents(h);
        std::copy(i.begin(), i.end(), solver_.injected().begin() + static_cast<std::ptrdiff_t>(3 * f));
    }
}

void EmtEngine::step_injections(Injections injections, double t_end, double h) {
    // One thing after the other for all of them: each is a chain of operations, and a processor works on several.
    auto const each_in_service = [&](auto const& job) { // of what is not nothing measures, charges or ages
        for (int const index : injections) {
            auto const i = static_cast<std::size_t>(index);
            if (!converters_[i].tripped()) {
                job(i, following_[i], converters_[i]);
            }
        }
    };
    each_in_service([&](std::size_t i, Following& injection, GridFollowing const& converter) {
        if (injection.by_phase) {
            PhaseFollowing::Powers power;
            std::array<double, 3> v{};
            for (std::size_t k = 0; k < 3; ++k) {
                power[k] = injection.model->phase_power_va(k, t_end, phase_currents_[i].voltage_pu(k), h);
                v[k] = solver_.node_voltage(injection.node + static_cast<int>(k));
            }
            phase_currents_[i].step(v, power, h);
        } else if (converter.ceased()) { // regulates and ages nothing
            injection.model->disconnect();
            injection.power = 0;
        } else {
            injection.power = wanted(injection, t_end, converter.voltage_pu(), h);
        }
    });
    each_in_service([&](std::size_t, Following const& at, GridFollowing& converter) {
        if (!at.by_phase) {
            converter.measure(to_space(solver_.node_voltage(at.node), solver_.node_voltage(at.node + 1),
                                       solver_.node_voltage(at.node + 2)),
                              h);
        }
    });
    each_in_service(
        [&, share = GridFollowing::current_share(h)](std::size_t, Following const& at, GridFollowing& converter) {
            if (!at.by_phase) {
                converter.control(at.power, h, share);
            }
        });
}

} // namespace gridspace::sim::emt
