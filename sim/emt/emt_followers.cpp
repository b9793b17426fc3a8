// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"
#include "sim/powerflow/load_power.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// Elements whose power is given: photovoltaics, generators without dynamics, vehicles, and loads that are not constant
/// impedances.
namespace gridspace::sim::emt {

using Follower = NetworkCircuit::Follower;

namespace {

/// Integral gain of a converter that regulates its voltage: p.u. of its power per p.u. voltage and second.
constexpr double kVoltageRegulator = 50;

} // namespace

double EmtEngine::scale(Ref const& name, double t) const {
    Profile const* profile = name.empty() ? nullptr : find(network_.profiles, name.name);
    return profile == nullptr ? 1.0 : profile_value(*profile, t / 3600, options_.start_hour_of_day);
}

std::complex<double> EmtEngine::wanted(std::size_t follower, double t, double v, std::complex<double>& lagged,
                                       double h) {
    Follower const& f = parts_.followers[follower];
    // What its filter gives, a converter takes back.
    std::complex<double> const filter{0, 1e3 * f.filter_kvar * v * v};
    switch (f.kind) {
    case Follower::Kind::pv: {
        Pv const& pv = network_.pv[f.element];
        double p = pv.p_kw * scale(pv.scale, t);
        if (pv.rating_kva > 0) {
            p = std::min(p, pv.rating_kva * pv.power_factor);
        }
        return std::complex<double>{1e3 * p,
                                    -1e3 * p * std::sqrt(1 - pv.power_factor * pv.power_factor) / pv.power_factor} -
               filter;
    }
    case Follower::Kind::generator: {
        Generator const& g = network_.generators[f.element];
        if (g.role == GeneratorRole::pq) {
            return std::complex<double>{1e3 * g.p_kw, 1e3 * g.q_kvar} - filter;
        }
        double& q = regulated_kvar_[follower];
        double const rating = g.rating_kva > 0 ? g.rating_kva : std::max(std::abs(g.p_kw), network_.power_kva);
        q += kVoltageRegulator * rating * (g.voltage_setpoint_pu - v) * h;
        q = std::clamp(q, g.q_min_kvar.value_or(-1e30),
                       std::max(g.q_min_kvar.value_or(-1e30), g.q_max_kvar.value_or(1e30)));
        return std::complex<double>{1e3 * g.p_kw, 1e3 * q} - filter;
    }
    case Follower::Kind::ev: {
        charge(f.element, h);
        Ev const& ev = network_.evs[f.element];
        return std::complex<double>{-evs_[f.element].current_a * ev.battery_v / ev.efficiency, 0} - filter;
    }
    case Follower::Kind::battery:
        return std::complex<double>{1e3 * discharge(f.element, t, h), 1e3 * network_.batteries[f.element].q_kvar} -
               filter;
    case Follower::Kind::dc_load: {
        Load const& load = network_.loads[f.element];
        double const target = load.p_kw * scale(load.scale, t);
        lagged = load.lag_s > 0 && h > 0 ? lagged + (target - lagged) * (h / (load.lag_s + h)) : target;
        return -1e3 * lagged - filter;
    }
    case Follower::Kind::load:
        break;
    }
    return -1e3 * beyond_star(network_.loads[f.element], 3, t, v, lagged, h);
}

/// i' = (reference - i) / lag; soc' = 100 i V / capacity; charging stops at soc_stop_percent.
void EmtEngine::charge(std::size_t index, double h) {
    Ev const& ev = network_.evs[index];
    EvState& s = evs_[index];
    if (h <= 0 || s.full) {
        return;
    }
    s.current_a += (s.reference_a - s.current_a) * (h / (ev.current_lag_s + h));
    s.soc_percent += 100 * s.current_a * ev.battery_v * h / (ev.capacity_kwh * 1e3 * 3600);
    if (s.soc_percent >= ev.soc_stop_percent) {
        s.soc_percent = ev.soc_stop_percent;
        s.current_a = 0;
        s.full = true;
    }
}

double EmtEngine::discharge(std::size_t index, double t, double h) {
    Battery const& b = network_.batteries[index];
    double& soc = battery_soc_[index];
    double const p_kw = battery_p_kw(b, scale(b.scale, t), soc);
    soc = std::clamp(soc + battery_soc_slope(b, p_kw) * h, b.soc_min_percent, b.soc_max_percent);
    return p_kw;
}

std::complex<double> EmtEngine::beyond_star(Load const& load, std::size_t phase, double t, double v,
                                            std::complex<double>& lagged, double h) const {
    double const q = load_q_kvar(load);
    std::complex<double> const nominal = phase == 3 ? std::complex{load.p_kw, q}
                                         : load.phase_p_kw.empty()
                                             ? std::complex{load.p_kw / 3, q / 3}
                                             : std::complex{load.phase_p_kw[phase], load.phase_q_kvar[phase]};
    VoltagePower const factor = load_factor(load, v);
    double const k = scale(load.scale, t);
    std::complex<double> const target{k * factor.p * nominal.real(), k * factor.q * nominal.imag()};
    lagged = load.lag_s > 0 && h > 0 ? lagged + (target - lagged) * (h / (load.lag_s + h)) : target;
    return lagged - nominal * v * v;
}

PhaseFollowing::Powers EmtEngine::wanted_by_phase(std::size_t follower, double t, double h) {
    Load const& load = network_.loads[parts_.followers[follower].element];
    PhaseFollowing::Powers out;
    for (std::size_t k = 0; k < 3; ++k) {
        out[k] = -1e3 * beyond_star(load, k, t, phase_followers_[follower].voltage_pu(k), demand_[follower][k], h);
    }
    return out;
}

std::vector<EmtEngine::BusPhases> EmtEngine::start_followers(std::vector<BusPhases> const& bus_v,
                                                             std::vector<double> const& generator_kvar) {
    followers_.clear();
    phase_followers_.clear();
    demand_.assign(parts_.followers.size(), {});
    regulated_kvar_.assign(parts_.followers.size(), 0.0);
    evs_.clear();
    for (Ev const& ev : network_.evs) {
        evs_.push_back({0, 0, ev.soc_start_percent, ev.soc_start_percent >= ev.soc_stop_percent});
    }
    battery_soc_.clear();
    for (Battery const& b : network_.batteries) {
        battery_soc_.push_back(b.soc_start_percent);
    }
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    std::vector<BusPhases> currents;
    for (std::size_t i = 0; i < parts_.followers.size(); ++i) {
        Follower const& f = parts_.followers[i];
        double const peak = parts_.bus_peak_v[f.bus];
        BusPhases v = bus_v[f.bus];
        bool const is_source =
            f.kind == Follower::Kind::pv || f.kind == Follower::Kind::generator || f.kind == Follower::Kind::battery;
        followers_.emplace_back(network_.frequency_hz, peak, f.max_peak_a, is_source);
        phase_followers_.emplace_back(network_.frequency_hz, peak);
        if (f.by_phase) {
            PhaseFollowing::Powers power;
            for (std::size_t k = 0; k < 3; ++k) {
                power[k] = -1e3 * beyond_star(network_.loads[f.element], k, 0, std::abs(v[k]), demand_[i][k], 0);
                v[k] *= peak;
            }
            currents.push_back(phase_followers_.back().start(v, power));
            continue;
        }
        if (f.kind == Follower::Kind::generator) {
            regulated_kvar_[i] = generator_kvar[f.element];
        }
        std::complex<double> const one = (v[0] + turn * v[1] + turn * turn * v[2]) / 3.0;
        std::complex<double> const power = wanted(i, 0, std::abs(one), demand_[i][0], 0);
        std::complex<double> const a = followers_.back().start(one * peak, power);
        currents.push_back({a, a / turn, a * turn});
    }
    return currents;
}

void EmtEngine::step_followers(double t_end, double h) {
    for (std::size_t f = 0; f < followers_.size(); ++f) {
        if (followers_[f].tripped()) {
            continue; // out of service: nothing measures, charges or ages
        }
        int const node = parts_.followers[f].node;
        double const a = solver_.node_voltage(node), b = solver_.node_voltage(node + 1),
                     c = solver_.node_voltage(node + 2);
        if (parts_.followers[f].by_phase) {
            phase_followers_[f].step({a, b, c}, wanted_by_phase(f, t_end, h), h);
        } else {
            // One that has ceased regulates and ages nothing.
            auto const power = followers_[f].ceased() ? std::complex<double>{}
                                                      : wanted(f, t_end, followers_[f].voltage_pu(), demand_[f][0], h);
            followers_[f].step(to_space(a, b, c), power, h);
        }
    }
}

} // namespace gridspace::sim::emt
