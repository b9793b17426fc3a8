// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/instrument_transformer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

} // namespace

double InstrumentTransformer::shown(double input) const {
    double const out = d_.factor * input;
    return d_.quantum > 0 ? std::round(out / d_.quantum) * d_.quantum : out;
}

void InstrumentTransformer::start(std::array<Complex, 3> const& input, double w, double h) {
    for (std::size_t k = 0; k < 3; ++k) {
        Phase& p = phases_[k];
        Complex through = input[k];
        if (d_.core) {
            // What backward Euler makes of a derivative at w.
            Complex const s = (1.0 - std::polar(1.0, -w * h)) / h;
            InstrumentData::Core const& c = *d_.core;
            Complex const flux = c.of == InstrumentData::Core::Of::current
                                     ? c.r_ohm * through / c.turns / (s + c.r_ohm / c.slopes.l)
                                     : through / (s + c.r_ohm / c.slopes.l);
            p.flux = flux.real() + c.remanence;
            through = c.of == InstrumentData::Core::Of::current ? through - c.turns * flux / c.slopes.l : s * flux;
        }
        p.in = p.out = through.real();
        if (d_.cutoff_hz > 0) {
            Complex const s{0, 2 / h * std::tan(w * h / 2)};
            double const wc = 2 * std::numbers::pi * d_.cutoff_hz;
            Complex const x1 = through * wc * wc / (s * s + std::numbers::sqrt2 * wc * s + wc * wc);
            p.x1 = x1.real();
            p.x2 = (s * x1).real();
            p.out = p.x1;
        }
    }
}

void InstrumentTransformer::step(std::array<double, 3> const& input, double h) {
    for (std::size_t k = 0; k < 3; ++k) {
        Phase& p = phases_[k];
        double through = input[k];
        if (d_.core) {
            InstrumentData::Core const& c = *d_.core;
            bool const ct = c.of == InstrumentData::Core::Of::current;
            double const driven = ct ? c.r_ohm * through / c.turns : through;
            p.flux = c.slopes.flux(p.flux + h * driven, h * c.r_ohm);
            double const magnetising = c.slopes.current(p.flux);
            through = ct ? through - c.turns * magnetising : through - c.r_ohm * magnetising;
        }
        p.out = through;
        if (d_.cutoff_hz > 0) {
            // x1' = x2, x2' = wc^2 (u - x1) - sqrt2 wc x2
            double const wc = 2 * std::numbers::pi * d_.cutoff_hz, half = h / 2;
            double const damping = std::numbers::sqrt2 * wc;
            double const x2 =
                (p.x2 * (1 - half * damping) + half * wc * wc * (p.in + through - 2 * p.x1 - half * p.x2)) /
                (1 + half * damping + half * half * wc * wc);
            p.x1 += half * (p.x2 + x2);
            p.x2 = x2;
            p.in = through;
            p.out = p.x1;
        }
    }
}

} // namespace gridspace::sim::emt
