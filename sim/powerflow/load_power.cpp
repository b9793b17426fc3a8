// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/load_power.hpp"

#include <cmath>

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

VoltagePower load_factor(Load const& load, double v, double floor_pu) {
    if (load.model == LoadModel::dc_constant_power) {
        // Its converter holds the power until its current is at the limit.
        double const most = kConverterOverload * v;
        return most < 1 ? VoltagePower{most, most, kConverterOverload, kConverterOverload} : VoltagePower{1, 1, 0, 0};
    }
    double const at = v < floor_pu ? floor_pu : v;
    Value p, q;
    switch (load.model) {
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
        p = power_law(at, load.exponent_p);
        q = power_law(at, load.exponent_q);
        break;
    case LoadModel::zip:
        p = zip(at, load.zip_p);
        q = zip(at, load.zip_q);
        break;
    }
    if (v < floor_pu) {
        double const square = v * v / (floor_pu * floor_pu), slope = 2 * v / (floor_pu * floor_pu);
        p = {p.f * square, p.f * slope};
        q = {q.f * square, q.f * slope};
    }
    return {p.f, q.f, p.slope, q.slope};
}

} // namespace gridspace::sim
