// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/controls.hpp"

#include "sim/opendss/circuit.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace gridspace::opendss {
namespace {

Complex at(Eigen::VectorXcd const& v, int node) {
    return node < 0 ? Complex{} : v[node];
}

/// Current into a conductor of an element.
Complex current_into(Element const& e, Eigen::VectorXcd const& v, int conductor) {
    Complex out{};
    for (std::size_t k = 0; k < e.nodes.size() && e.in_service; ++k) {
        out += e.y(conductor, static_cast<Eigen::Index>(k)) * at(v, e.nodes[k]);
    }
    return out;
}

/// The place of the phase that is looked at, by the magnitudes.
int pick(Watched watched, int phase, std::vector<Complex> const& values) {
    auto const less = [](Complex a, Complex b) { return std::abs(a) < std::abs(b); };
    switch (watched) {
    case Watched::largest:
        return static_cast<int>(std::max_element(values.begin(), values.end(), less) - values.begin());
    case Watched::smallest:
        return static_cast<int>(std::min_element(values.begin(), values.end(), less) - values.begin());
    default:
        return phase;
    }
}

double magnitude(Watched watched, int phase, std::vector<Complex> const& values) {
    if (watched == Watched::mean) {
        double sum = 0;
        for (Complex const x : values) {
            sum += std::abs(x);
        }
        return sum / static_cast<double>(values.size());
    }
    return std::abs(values[static_cast<std::size_t>(pick(watched, phase, values))]);
}

/// What a capacitor's control measures of these voltages to earth.
double measured_v(CapacitorControl const& c, std::vector<Complex> const& volts) {
    if (c.of_voltages == Watched::one && c.between_phases) {
        auto const phase = static_cast<std::size_t>(c.voltage_phase);
        return std::abs(volts[phase] - volts[(phase + 1) % volts.size()]);
    }
    return magnitude(c.of_voltages, c.voltage_phase, volts);
}

} // namespace

TapWish wish_of(Regulator const& r, Circuit const& circuit, Eigen::VectorXcd const& v) {
    Element const& e = circuit.elements[r.element];
    Transformer const& t = circuit.transformers.at(r.element);
    bool const remote = !r.remote.empty();
    std::vector<Complex> winding, measured;
    for (int k = 0; k < t.phases; ++k) {
        auto const [a, b] = t.ends(r.winding, k);
        winding.push_back(at(v, e.nodes[static_cast<std::size_t>(a)]) - at(v, e.nodes[static_cast<std::size_t>(b)]));
        if (remote) {
            int const own = r.remote[static_cast<std::size_t>(k)];
            int const other = t.windings[r.winding].delta && t.phases > 1
                                  ? r.remote[static_cast<std::size_t>((k + 1) % t.phases)]
                                  : -1;
            measured.push_back((at(v, own) - at(v, other)) / r.remote_ratio);
        } else {
            measured.push_back(winding.back() / r.pt_ratio);
        }
    }
    int const phase = pick(r.watched, r.phase, measured);
    Complex control = measured[static_cast<std::size_t>(phase)];
    if (!remote && (r.r_v != 0 || r.x_v != 0)) { // the current into the winding is minus that of the load
        auto const conductor = static_cast<int>(r.winding) * t.conductors() + phase;
        control += Complex{r.r_v, r.x_v} * current_into(e, v, conductor) / r.ct_primary_a;
    }
    TapWish wish{0, r.delay_s, std::abs(control)};
    double const local = std::abs(winding.front()) / r.pt_ratio;
    bool const limited = r.limit_v > 0 && (remote ? local : wish.measured_v) > r.limit_v;
    double const away = r.setpoint_v - wish.measured_v;
    double const step = t.windings[r.tap_winding].step();
    if ((std::abs(away) <= r.band_v / 2 && !limited) || r.most_steps == 0 || step <= 0) {
        return wish;
    }
    double const boost_v = limited ? r.limit_v - (remote ? local : wish.measured_v) : away;
    double const wanted = std::round(boost_v * r.pt_ratio / t.winding_v(r.winding) / step);
    wish.steps = static_cast<int>(std::clamp(wanted, -1e4, 1e4)) * (r.tap_winding == r.winding ? 1 : -1);
    if (r.inverse_time) {
        wish.delay_s = r.delay_s / std::min(10.0, 2 * std::abs(away) / r.band_v);
    }
    double const tap = t.windings[r.tap_winding].tap;
    bool const at_end = wish.steps > 0 ? tap >= t.windings[r.tap_winding].most_tap - step / 1e6
                                       : tap <= t.windings[r.tap_winding].least_tap + step / 1e6;
    wish.steps = at_end ? 0 : wish.steps;
    return wish;
}

bool change_tap(Regulator const& r, Circuit& circuit, int steps) {
    Transformer& t = circuit.transformers.at(r.element);
    WindingData& w = t.windings[r.tap_winding];
    // Seven tenths of the way, at least one tap: the voltage answers to the other regulators as well.
    int const taps = std::min(std::max(1, static_cast<int>(0.7 * std::abs(steps))), r.most_steps);
    double const before = w.tap;
    w.tap = std::clamp(w.tap + (steps > 0 ? taps : -taps) * w.step(), w.least_tap, w.most_tap);
    circuit.elements[r.element].y = t.admittance();
    return w.tap != before;
}

int tap_position(Regulator const& r, Circuit const& circuit) {
    WindingData const& w = circuit.transformers.at(r.element).windings[r.tap_winding];
    return w.step() > 0 ? static_cast<int>(std::lround((w.tap - (w.least_tap + w.most_tap) / 2) / w.step())) : 0;
}

std::optional<bool> wish_of(CapacitorControl const& c, Circuit const& circuit, Eigen::VectorXcd const& v, double hour) {
    Element const& e = circuit.elements[c.monitored];
    std::vector<Complex> volts, amperes;
    Complex power{};
    for (int k = 0; k < e.conductors; ++k) {
        int const conductor = c.terminal * e.conductors + k;
        volts.push_back(at(v, e.nodes[static_cast<std::size_t>(conductor)]));
        amperes.push_back(current_into(e, v, conductor));
        power += volts.back() * std::conj(amperes.back());
    }
    bool const closed = circuit.elements[c.capacitor].in_service;
    double const seen_v = measured_v(c, volts) / c.pt_ratio;
    using Kind = CapacitorControl::Kind;
    if (c.voltage_overrides && c.kind != Kind::voltage) {
        if (!closed && seen_v < c.least_v) {
            return true;
        }
        if (closed && seen_v > c.most_v) {
            return false;
        }
    }
    auto const by = [&](bool wants_closed, bool wants_open) -> std::optional<bool> {
        return !closed && wants_closed ? std::optional{true}
               : closed && wants_open  ? std::optional{false}
                                       : std::nullopt;
    };
    switch (c.kind) {
    case Kind::current: {
        double const a = magnitude(c.of_currents, c.current_phase, amperes) / c.ct_ratio;
        return by(a > c.on, a < c.off);
    }
    case Kind::voltage:
        return by(seen_v<c.on, seen_v> c.off);
    case Kind::kvar:
        return by(power.imag() / 1e3 > c.on, power.imag() / 1e3 < c.off);
    case Kind::power_factor: {
        double const size = std::abs(power), pf = size > 0 ? std::abs(power.real()) / size : 1;
        double const scale = power.imag() < 0 ? 2 - pf : pf;
        return by(scale < c.pf_on && power.imag() / 1e3 > c.least_kvar, scale > c.pf_off);
    }
    case Kind::time: {
        double const day = std::fmod(hour, 24);
        bool const on = c.on < c.off ? day >= c.on && day < c.off : day >= c.on || day < c.off;
        return by(on, !on);
    }
    }
    return std::nullopt;
}

} // namespace gridspace::opendss
