// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/load/load.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>

/// What a load draws.
namespace gridspace::sim {
namespace {

struct Value {
    double f{0}, slope{0};
};

Value power_law(double v, double exponent) {
    double const f = std::pow(v, exponent);
    return {f, exponent * f / v};
}

Value zip(double v, std::array<double, 3> const& shares) {
    return {shares[0] * v * v + shares[1] * v + shares[2], 2 * shares[0] * v + shares[1]};
}

} // namespace

double Load::nominal_q_kvar() const {
    if (q_kvar) {
        return *q_kvar;
    }
    if (is_dc()) {
        return 0;
    }
    return p_kw * std::sqrt(1 - power_factor * power_factor) / power_factor;
}

Complex Load::nominal_kva(std::size_t phase) const {
    return phase_p_kw.empty() ? nominal_kva() / 3.0 : Complex{phase_p_kw[phase], phase_q_kvar[phase]};
}

VoltagePower Load::factor(double v, double floor_pu) const {
    if (model == LoadModel::dc_constant_power) {
        // Its converter holds the power until its current is at the limit.
        double const most = kConverterOverload * v;
        return most < 1 ? VoltagePower{most, most, kConverterOverload, kConverterOverload} : VoltagePower{1, 1, 0, 0};
    }
    double const at = v < floor_pu ? floor_pu : v;
    Value p, q;
    switch (model) {
    case LoadModel::constant_power:
    case LoadModel::dc_constant_power:
        p = q = {1, 0};
        break;
    case LoadModel::constant_current:
        p = q = {at, 1};
        break;
    case LoadModel::constant_impedance:
    case LoadModel::dc_resistive:
        p = q = {at * at, 2 * at};
        break;
    case LoadModel::exponential:
        p = power_law(at, exponent_p);
        q = power_law(at, exponent_q);
        break;
    case LoadModel::zip:
        p = zip(at, zip_p);
        q = zip(at, zip_q);
        break;
    }
    if (v < floor_pu) {
        double const square = v * v / (floor_pu * floor_pu), slope = 2 * v / (floor_pu * floor_pu);
        p = {p.f * square, p.f * slope};
        q = {q.f * square, q.f * slope};
    }
    return {p.f, q.f, p.slope, q.slope};
}

std::pair<double, double> Load::impedance_shares() const {
    switch (model) {
    case LoadModel::constant_impedance:
    case LoadModel::dc_resistive:
        return {1, 1};
    case LoadModel::constant_current:
        return {0.5, 0.5};
    case LoadModel::exponential:
        return {std::clamp(exponent_p / 2, 0.0, 1.0), std::clamp(exponent_q / 2, 0.0, 1.0)};
    case LoadModel::zip:
        return {zip_p[0], zip_q[0]};
    case LoadModel::constant_power:
    case LoadModel::dc_constant_power:
        break;
    }
    return {0, 0};
}

bool Load::set(std::string_view quantity, double value) {
    if (quantity == "p_kw") {
        p_kw = value;
    } else if (quantity == "q_kvar") {
        q_kvar = value;
    } else if (quantity == "power_factor" && value > 0 && value <= 1) {
        power_factor = value;
        q_kvar.reset();
    } else if (quantity == "demand_pu") {
        demand_pu = value;
    } else {
        return false;
    }
    return true;
}

double Load::value(std::string_view quantity, Surroundings const&) const {
    return quantity == "p_kw"     ? p_kw
           : quantity == "q_kvar" ? nominal_q_kvar()
           : quantity == "demand_pu"
               ? demand_pu
               : (q_kvar && p_kw != 0 ? std::abs(p_kw) / std::hypot(p_kw, *q_kvar) : power_factor);
}

std::optional<Refusal> Load::refuses(std::string_view quantity, Surroundings const&, bool) const {
    if (!phase_p_kw.empty()) {
        return Refusal{"this load has powers by phase",
                       "take it out of service with `disconnect`, or describe it with p_kw"};
    }
    bool const reactive = quantity == "q_kvar" || quantity == "power_factor";
    return reactive && is_dc() ? std::optional{Refusal{"a DC load has only p_kw", ""}} : std::nullopt;
}

} // namespace gridspace::sim
