// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/components.hpp"

#include "sim/powerflow/load_power.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::phasor {
namespace {

/// Current into the network of something that consumes power s at voltage v. At a dead bus nothing flows.
Complex consumed(Complex s, Complex v) {
    return std::norm(v) < 1e-12 ? Complex{} : -std::conj(s / v);
}

std::vector<SignalDef> powers(std::string const& prefix) {
    return {{prefix + ".p_kw", "kW"}, {prefix + ".q_kvar", "kvar"}};
}

/// What a converter of this rating can give of `s` at a voltage |v| (all p.u.): its current is limited.
Complex within(Complex s, double v, double rating) {
    double const most = kConverterOverload * rating * v;
    double const size = std::abs(s);
    return size > most ? s * (most / size) : s;
}

double part(Complex s, std::size_t signal) {
    return signal == 0 ? s.real() : s.imag();
}

} // namespace

LoadComponent::LoadComponent(Load const& load, std::size_t bus, double base_kva, Scale scale)
    : Component{bus}, load_{load}, base_kva_{base_kva}, scale_{std::move(scale)} {}

Complex LoadComponent::demand(double t, double v) const {
    double const k = scale_(t) / base_kva_;
    VoltagePower const f = load_factor(load_, v);
    return {load_.p_kw * k * f.p, load_q_kvar(load_) * k * f.q};
}

Complex LoadComponent::power(double t, std::span<double const> x, double v) const {
    if (!connected_) {
        return {};
    }
    return x.empty() ? demand(t, v) : Complex{x[0], x[1]};
}

void LoadComponent::start(double t, Complex v, std::span<double> x) {
    if (!x.empty()) {
        Complex const s = demand(t, std::abs(v));
        x[0] = s.real();
        x[1] = s.imag();
    }
}

Complex LoadComponent::flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const {
    if (!x.empty()) {
        Complex const s = demand(t, std::abs(v));
        dx[0] = (s.real() - x[0]) / load_.lag_s;
        dx[1] = (s.imag() - x[1]) / load_.lag_s;
    }
    return consumed(power(t, x, std::abs(v)), v);
}

std::vector<SignalDef> LoadComponent::signals() const {
    return powers("load." + load_.name.name);
}

double LoadComponent::value(std::size_t signal, double t, std::span<double const> x, Complex v) const {
    return part(power(t, x, std::abs(v)), signal) * base_kva_;
}

PvComponent::PvComponent(Pv const& pv, std::size_t bus, double base_kva, Scale scale)
    : Component{bus}, pv_{pv}, base_kva_{base_kva}, scale_{std::move(scale)} {}

Complex PvComponent::power(double t, double v) const {
    if (!connected_) {
        return {};
    }
    double p = pv_.p_kw * scale_(t);
    if (pv_.rating_kva > 0) {
        p = std::min(p, pv_.rating_kva * pv_.power_factor);
    }
    double const rating = pv_.rating_kva > 0 ? pv_.rating_kva : pv_.p_kw / pv_.power_factor;
    Complex const s{p, -p * std::sqrt(1 - pv_.power_factor * pv_.power_factor) / pv_.power_factor};
    return within(s, v, rating) / base_kva_;
}

Complex PvComponent::flow(double t, std::span<double const>, Complex v, std::span<double>) const {
    return consumed(-power(t, std::abs(v)), v);
}

std::vector<SignalDef> PvComponent::signals() const {
    return powers("pv." + pv_.name.name);
}

double PvComponent::value(std::size_t signal, double t, std::span<double const>, Complex v) const {
    return part(power(t, std::abs(v)), signal) * base_kva_;
}

EvComponent::EvComponent(Ev const& ev, std::size_t bus, double base_kva)
    : Component{bus}, ev_{ev}, base_kva_{base_kva} {}

void EvComponent::start(double, Complex, std::span<double> x) {
    x[0] = 0;
    x[1] = ev_.soc_start_percent;
    full_ = ev_.soc_start_percent >= ev_.soc_stop_percent;
}

double EvComponent::power_kw(double current_a) const {
    return current_a * ev_.battery_v / ev_.efficiency / 1e3;
}

Complex EvComponent::flow(double, std::span<double const> x, Complex v, std::span<double> dx) const {
    bool const charging = connected_ && !full_;
    double const target = charging ? reference_a_ : 0;
    // Without a lag the state still exists; a microsecond response is an ideal converter at any useful step.
    dx[0] = (target - x[0]) / std::max(ev_.current_lag_s, 1e-6);
    double const current = charging ? x[0] : 0;
    dx[1] = 100 * current * ev_.battery_v / (ev_.capacity_kwh * 1e3 * 3600);
    return consumed(within({power_kw(current) / base_kva_, 0}, std::abs(v), power_kw(ev_.max_current_a) / base_kva_),
                    v);
}

double EvComponent::event(double, std::span<double const> x) const {
    return ev_.soc_stop_percent - x[1];
}

void EvComponent::on_event(std::span<double> x) {
    full_ = true;
    x[0] = 0;
    x[1] = ev_.soc_stop_percent;
}

void EvComponent::set_reference(double current_a) {
    reference_a_ = std::clamp(current_a, 0.0, ev_.max_current_a);
}

std::vector<SignalDef> EvComponent::signals() const {
    std::string const prefix = "ev." + ev_.name.name;
    return {{prefix + ".soc_percent", "%"},
            {prefix + ".current_a", "A"},
            {prefix + ".reference_a", "A"},
            {prefix + ".p_kw", "kW"}};
}

double EvComponent::value(std::size_t signal, double, std::span<double const> x, Complex v) const {
    double const current = connected_ && !full_ ? x[0] : 0;
    double const kw = power_kw(current);
    switch (signal) {
    case 0:
        return x[1];
    case 1:
        return current;
    case 2:
        return reference_a_;
    default:
        return within({kw, 0}, std::abs(v), power_kw(ev_.max_current_a)).real();
    }
}

SourceComponent::SourceComponent(Network const& network, Source const& source, std::size_t bus)
    : Component{bus}, name_{source.name.name}, base_kva_{network.power_kva},
      emf_{std::polar(source.voltage_pu, source.angle_deg * std::numbers::pi / 180)} {
    double const omega = 2 * std::numbers::pi * network.frequency_hz;
    admittance_ = base_impedance(network, network.buses[bus]) / Complex{source.r_ohm, omega * source.l_mh * 1e-3};
}

Complex SourceComponent::flow(double, std::span<double const>, Complex v, std::span<double>) const {
    return (emf_ - v) * admittance_;
}

std::vector<SignalDef> SourceComponent::signals() const {
    return powers("source." + name_);
}

double SourceComponent::value(std::size_t signal, double, std::span<double const>, Complex v) const {
    return part(v * std::conj((emf_ - v) * admittance_), signal) * base_kva_;
}

BatteryComponent::BatteryComponent(Battery const& battery, std::size_t bus, double base_kva, Scale scale)
    : Component{bus}, battery_{battery}, base_kva_{base_kva}, scale_{std::move(scale)} {}

void BatteryComponent::start(double, Complex, std::span<double> x) {
    x[0] = battery_.soc_start_percent;
    at_ = x[0] <= battery_.soc_min_percent ? -1 : x[0] >= battery_.soc_max_percent ? 1 : 0;
}

double BatteryComponent::asked_kw(double t) const {
    return connected_ ? battery_p_kw(battery_, scale_(t)) : 0;
}

Complex BatteryComponent::power(double t, double v) const {
    if (!connected_) {
        return {};
    }
    double const p = asked_kw(t);
    bool const spent = p > 0 ? at_ < 0 : at_ > 0;
    return within({spent ? 0 : p, battery_.q_kvar}, v, battery_.rating_kva) / base_kva_;
}

Complex BatteryComponent::flow(double t, std::span<double const>, Complex v, std::span<double> dx) const {
    Complex const s = power(t, std::abs(v));
    dx[0] = battery_soc_slope(battery_, s.real() * base_kva_);
    return consumed(-s, v);
}

double BatteryComponent::event(double t, std::span<double const> x) const {
    constexpr double kLeftPercent = 1e-6; // this far from a limit it is no longer at it
    double const p = asked_kw(t);
    if (at_ < 0) {
        return battery_.soc_min_percent + kLeftPercent - x[0];
    }
    if (at_ > 0) {
        return x[0] - battery_.soc_max_percent + kLeftPercent;
    }
    return p == 0 ? 1 : p > 0 ? x[0] - battery_.soc_min_percent : battery_.soc_max_percent - x[0];
}

void BatteryComponent::on_event(std::span<double> x) {
    if (at_ != 0) {
        at_ = 0;
        return;
    }
    at_ = x[0] - battery_.soc_min_percent < battery_.soc_max_percent - x[0] ? -1 : 1;
    x[0] = at_ < 0 ? battery_.soc_min_percent : battery_.soc_max_percent;
}

std::vector<SignalDef> BatteryComponent::signals() const {
    auto out = powers("battery." + battery_.name.name);
    out.push_back({"battery." + battery_.name.name + ".soc_percent", "%"});
    return out;
}

double BatteryComponent::value(std::size_t signal, double t, std::span<double const> x, Complex v) const {
    return signal == 2 ? x[0] : part(power(t, std::abs(v)), signal) * base_kva_;
}

FixedPowerComponent::FixedPowerComponent(std::string name, Complex power_pu, double rating_pu, std::size_t bus,
                                         double base_kva)
    : Component{bus}, name_{std::move(name)}, power_{power_pu}, rating_{std::max(rating_pu, std::abs(power_pu))},
      base_kva_{base_kva} {}

Complex FixedPowerComponent::power(Complex v) const {
    return connected_ ? within(power_, std::abs(v), rating_) : Complex{};
}

Complex FixedPowerComponent::flow(double, std::span<double const>, Complex v, std::span<double>) const {
    return consumed(-power(v), v);
}

std::vector<SignalDef> FixedPowerComponent::signals() const {
    return powers("generator." + name_);
}

double FixedPowerComponent::value(std::size_t signal, double, std::span<double const>, Complex v) const {
    return part(power(v), signal) * base_kva_;
}

} // namespace gridspace::sim::phasor
