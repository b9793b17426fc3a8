// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/pv/pv_array.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <cmath>
#include <utility>

namespace gridspace::sim {
namespace {

constexpr double kKelvin = 273.15, kReferenceK = kKelvin + 25;
constexpr double kBoltzmannEvK = 8.617333262e-5;
constexpr double kBandGapEv = 1.121, kBandGapPerK = -0.0002677; ///< silicon; De Soto, eq. 11

/// Where a function falls through 0 that falls ever steeper: Newton's steps come down from `v`, beyond that, and never
/// pass it. f(v): value and slope.
template <class F>
double falls_through_zero(F const& f, double v) {
    constexpr int kMost = 60;
    for (int i = 0; i < kMost; ++i) {
        auto const [value, slope] = f(v);
        double const down = value / slope;
        v -= down;
        if (!(down > 1e-13 * v)) {
            break;
        }
    }
    return v;
}

} // namespace

void PvArray::fields(config::Fields& f) {
    using namespace elements;
    f.number("series", series, positive("modules in a string"));
    f.number("strings", strings, positive("strings in parallel"));
    f.number("il_a", il_a, positive("light current of a module", true));
    f.number("i0_a", i0_a, positive("saturation current of its diode", true));
    f.number("rs_ohm", rs_ohm, not_negative("series resistance", true));
    f.number("rsh_ohm", rsh_ohm, positive("shunt resistance", true));
    f.number("a_v", a_v, positive("modified ideality factor: ideality, cells in series, thermal voltage", true));
    f.number("alpha_a_k", alpha_a_k, any("change of the short-circuit current with temperature"));
    f.number("noct_c", noct_c, positive("cell temperature at 800 W/m2 and 20 degrees"));
    f.number("efficiency", efficiency, at_most_one("of the inverter"));
    f.number("mppt_s", mppt_s, not_negative("time constant of the tracker; 0: always at the maximum"));
}

double PvArray::Module::current_a(double v) const {
    return il - i0 * std::expm1(v / a) - v / rsh;
}

double PvArray::Module::slope_of_power(double v) const {
    double const i = current_a(v), di = -i0 / a * std::exp(v / a) - 1 / rsh;
    return (1 - rs * di) * i + (v - rs * i) * di;
}

double PvArray::Module::bend_of_power(double v) const {
    double const bend = -i0 / (a * a) * std::exp(v / a), i = current_a(v), di = a * bend - 1 / rsh;
    return 2 * (1 - rs * di) * di + (v - 2 * rs * i) * bend;
}

double PvArray::Module::best() const {
    return il > 0 ? falls_through_zero([this](double v) { return std::pair{slope_of_power(v), bend_of_power(v)}; },
                                       a * std::log1p(il / i0))
                  : 0;
}

double PvArray::Module::above_best(double w) const {
    double const highest = best();
    return il > 0 && w < power_w(highest)
               ? falls_through_zero([&](double v) { return std::pair{power_w(v) - w, slope_of_power(v)}; },
                                    a * std::log1p(il / i0))
               : highest;
}

PvArray::Module PvArray::module_at(double sun, double ambient_c) const {
    double const t = cell_c(sun, ambient_c) + kKelvin, share = t / kReferenceK;
    double const gap = kBandGapEv * (1 + kBandGapPerK * (t - kReferenceK));
    double const light = sun > 0 ? sun * (il_a + alpha_a_k * (t - kReferenceK)) : 0;
    return {.il = light,
            .i0 = i0_a * share * share * share *
                  std::exp(kBandGapEv / (kBoltzmannEvK * kReferenceK) - gap / (kBoltzmannEvK * t)),
            .rsh = sun > 0 ? rsh_ohm / sun : rsh_ohm,
            .rs = rs_ohm,
            .a = a_v * share};
}

} // namespace gridspace::sim
