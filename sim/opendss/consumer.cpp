// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/consumer.hpp"

#include <cmath>

namespace gridspace::opendss {

Complex LoadLaw::admittance() const {
    return std::conj(power_va) / (nominal_v * nominal_v);
}

Complex LoadLaw::current(Complex v) const {
    double const pu = std::abs(v) / nominal_v;
    if (model == 2 || !(pu > 0)) {
        return admittance() * v;
    }
    Complex out = pu <= least_pu ? below(v, pu) : pu > most_pu ? above(v) : within(v, pu);
    if (model == 8 && shares[6] > 0 && pu > low_pu) { // dropout
        out *= 0.5 * (1 + std::tanh(500 * (pu - shares[6])));
    }
    return out;
}

Complex LoadLaw::in_parts(double current, double power) const {
    Complex const y = admittance();
    if (model == 8) {
        return {y.real() * (shares[0] + shares[1] * current + shares[2] * power),
                y.imag() * (shares[3] + shares[4] * current + shares[5] * power)};
    }
    return y * (model == 5 ? current : power);
}

Complex LoadLaw::above(Complex v) const {
    if (model == 6 || model == 7) {
        return Complex{admittance().real() / (most_pu * most_pu), -fixed_var / (nominal_v * nominal_v)} * v;
    }
    return in_parts(1 / most_pu, 1 / (most_pu * most_pu)) * v;
}

Complex LoadLaw::below(Complex v, double pu) const {
    if (pu <= low_pu) {
        return admittance() * v;
    }
    if (model == 6 || model == 7) {
        return Complex{admittance().real() / (least_pu * least_pu), -fixed_var / (nominal_v * nominal_v)} * v;
    }
    // Of nominal current: low_pu at low_pu, and a straight line to that at least_pu.
    auto const on_line = [&](double at_least_pu) {
        return (low_pu + (at_least_pu - low_pu) * (pu - low_pu) / (least_pu - low_pu)) / pu;
    };
    return in_parts(on_line(1), on_line(1 / least_pu)) * v;
}

Complex LoadLaw::within(Complex v, double pu) const {
    double const p = power_va.real(), q = power_va.imag();
    auto const drawn = [&](double active, double reactive) { return std::conj(Complex{active, reactive} / v); };
    switch (model) {
    case 3: // constant active power, reactive power of an impedance
        return drawn(p, q * pu * pu);
    case 4:
        return drawn(p * std::pow(pu, exponent_p), q * std::pow(pu, exponent_q));
    case 5:
        return drawn(p * pu, q * pu);
    case 6:
        return drawn(p, fixed_var);
    case 7:
        return drawn(p, fixed_var * pu * pu);
    case 8:
        return drawn(p * (shares[0] * pu * pu + shares[1] * pu + shares[2]),
                     q * (shares[3] * pu * pu + shares[4] * pu + shares[5]));
    default:
        return drawn(p, q);
    }
}

} // namespace gridspace::opendss
