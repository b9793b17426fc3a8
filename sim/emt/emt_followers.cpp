// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"
#include "sim/powerflow/load_power.hpp"

#include <algorithm>
#include <cmath>

/// Elements whose power is given: photovoltaics, generators without dynamics, and loads that are not constant
/// impedances.
namespace gridspace::sim::emt {

using Follower = NetworkCircuit::Follower;

double EmtEngine::scale(Ref const& name, double t) const {
    Profile const* profile = name.empty() ? nullptr : find(network_.profiles, name.name);
    return profile == nullptr ? 1.0 : profile_value(*profile, t / 3600, options_.start_hour_of_day);
}

std::complex<double> EmtEngine::wanted(std::size_t follower, double t, double v, std::complex<double>& lagged,
                                       double h) const {
    Follower const& f = parts_.followers[follower];
    switch (f.kind) {
    case Follower::Kind::pv: {
        Pv const& pv = network_.pv[f.element];
        double p = pv.p_kw * scale(pv.scale, t);
        if (pv.rating_kva > 0) {
            p = std::min(p, pv.rating_kva * pv.power_factor);
        }
        return {1e3 * p, -1e3 * p * std::sqrt(1 - pv.power_factor * pv.power_factor) / pv.power_factor};
    }
    case Follower::Kind::generator: {
        Generator const& g = network_.generators[f.element];
        return {1e3 * g.p_kw, 1e3 * g.q_kvar};
    }
    case Follower::Kind::load:
        break;
    }
    // The star of the load draws its nominal power times v^2; the rest is injected.
    Load const& load = network_.loads[f.element];
    VoltagePower const factor = load_factor(load, v);
    double const k = scale(load.scale, t);
    std::complex<double> const target{k * factor.p * load.p_kw, k * factor.q * load_q_kvar(load)};
    lagged = load.lag_s > 0 && h > 0 ? lagged + (target - lagged) * (h / (load.lag_s + h)) : target;
    std::complex<double> const star{load.p_kw * v * v, load_q_kvar(load) * v * v};
    return -1e3 * (lagged - star);
}

std::vector<std::complex<double>> EmtEngine::start_followers(std::vector<std::complex<double>> const& bus_v) {
    followers_.clear();
    demand_.assign(parts_.followers.size(), {});
    std::vector<std::complex<double>> currents;
    for (std::size_t i = 0; i < parts_.followers.size(); ++i) {
        Follower const& f = parts_.followers[i];
        followers_.emplace_back(network_.frequency_hz, parts_.bus_peak_v[f.bus], f.max_peak_a);
        std::complex<double> const power = wanted(i, 0, std::abs(bus_v[f.bus]), demand_[i], 0);
        currents.push_back(followers_.back().start(bus_v[f.bus] * parts_.bus_peak_v[f.bus], power));
    }
    return currents;
}

} // namespace gridspace::sim::emt
