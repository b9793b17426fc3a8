// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/source_injections.hpp"

#include "sim/components/faces/converter.hpp"
#include "sim/powerflow/two_port.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::phasor {
namespace {

constexpr Kind kGenerator{
    .section = "generators", .doc = "", .word = "generator", .prefix = "generator", .feeds = true};

} // namespace

SourceInjection::SourceInjection(Network const& network, Source const& source, std::size_t bus)
    : PhasorInjection{bus}, name_{source.name.name}, base_kva_{network.power_kva}, nominal_hz_{network.frequency_hz},
      voltage_pu_{source.voltage_pu}, angle_rad_{source.angle_deg * std::numbers::pi / 180} {
    double const omega = 2 * std::numbers::pi * network.frequency_hz;
    admittance_ = base_impedance(network, network.buses[bus]) / Complex{source.r_ohm, omega * source.l_mh * 1e-3};
}

void SourceInjection::change(double t, std::string_view quantity, double value) {
    if (quantity == "voltage_pu") {
        voltage_pu_ = value;
        return;
    }
    angle_rad_ += slip_rad_s_ * (t - since_s_);
    since_s_ = t;
    slip_rad_s_ = 2 * std::numbers::pi * (value - nominal_hz_);
}

Complex SourceInjection::emf(double t) const {
    return std::polar(voltage_pu_, angle_rad_ + slip_rad_s_ * (t - since_s_));
}

Complex SourceInjection::flow(double t, std::span<double const>, Complex v, std::span<double>) const {
    return (emf(t) - v) * admittance_;
}

std::vector<SignalDef> SourceInjection::signals() const {
    return {{"source." + name_ + ".p_kw", "kW"}, {"source." + name_ + ".q_kvar", "kvar"}};
}

double SourceInjection::value(std::size_t signal, double t, std::span<double const>, Complex v) const {
    Complex const s = v * std::conj((emf(t) - v) * admittance_);
    return (signal == 0 ? s.real() : s.imag()) * base_kva_;
}

GivenPower::GivenPower(Generator const& g, std::size_t bus, double base_kva)
    : PowerInjection{kGenerator, g.name, bus, base_kva}, power_{Complex{g.p_kw, g.q_kvar} / base_kva},
      rating_{std::max(g.rating_kva / base_kva, std::abs(power_))} {}

bool GivenPower::set(std::string_view quantity, double value) {
    if (quantity == "voltage_setpoint_pu") {
        return false;
    }
    double const pu = value / base_kva();
    power_ = quantity == "p_kw" ? Complex{pu, power_.imag()} : Complex{power_.real(), pu};
    rating_ = std::max(rating_, std::abs(power_));
    return true;
}

Complex GivenPower::power(double, std::span<double const>, double v) const {
    return within_rating(power_, v, rating_);
}

} // namespace gridspace::sim::phasor
