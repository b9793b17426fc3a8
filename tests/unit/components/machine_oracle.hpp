// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numbers>
#include <utility>
#include <vector>

/// One machine behind a line: in words, and by equations of its own with Runge-Kutta.
namespace gridspace::sim::machine_oracle {

using Phasor = std::complex<double>;

inline TimeBase const kSteps{Rational{1, 12000}};
constexpr double kR = 0.02, kX = 0.4; ///< of the line, p.u.
constexpr double kOmega = 2 * std::numbers::pi * 60;

/// `more`: further keys of its type.
inline std::string text_of(std::string const& avr, std::string const& more = "") {
    return fmt::format("gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
                       "buses: {{A: {{voltage_v: 400}}, B: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A}}}}\n"
                       "lines: {{L: {{from: A, to: B, r_ohm: {}, l_mh: {}}}}}\n"
                       "machine_types: {{m: {{constants_pu: {{xd: 1.8, xq: 1.7, xd1: 0.3, xd2: 0.25, xq2: 0.25, xl: "
                       "0.16, ra: 0.003}}, times_s: {{td01: 8, td02: 0.03, tq02: 0.07}}, inertia_h_s: 3.5, {}avr: "
                       "{{{}}}}}}}\n"
                       "machines: {{M: {{bus: B, type: m, rating_kva: 100, p_kw: 70, voltage_setpoint_pu: 1.0}}}}\n",
                       kR * 1.6, kX * 1.6 / kOmega * 1e3, more, avr);
}

/// The machine of text_of(); the stator is solved with the line in the machine's frame.
struct Rotor {
    double xd{1.8}, xq{1.7}, xd1{0.3}, x2{0.25}, xl{0.16}, ra{0.003}, td01{8}, td02{0.03}, tq02{0.07}, h{3.5};
    double sat_a{0}, sat_b{0}; ///< what the field needs beside E'q: b (E'q - a)^2 above a
    double p_ref{0}, v_ref{0};
    Phasor source;

    enum { eq1, psi1d, psi2q, speed, angle, rotor_states };

    struct Stator {
        double id, iq, v, field_current, torque;
        Phasor power;
    };
    template <class State>
    [[nodiscard]] Stator stator(State const& s) const {
        double const g = (x2 - xl) / (xd1 - xl), k = (xq - x2) / (xq - xl);
        double const flux_d = g * s[eq1] + (1 - g) * s[psi1d], flux_q = k * s[psi2q];
        Phasor const e = source * std::polar(1.0, std::numbers::pi / 2 - s[angle]);
        // v + (ra + j x2) i = j flux, v = e + (r + j x) i: one impedance behind another, round to both axes
        Phasor const j{0, 1}, i = (j * Phasor{flux_d, flux_q} - e) / Phasor{ra + kR, x2 + kX};
        Phasor const v = e + Phasor{kR, kX} * i;
        Stator out{i.real(), i.imag(), std::abs(v), 0, flux_d * i.imag() - flux_q * i.real(), v * std::conj(i)};
        double const saturated = s[eq1] > sat_a ? sat_b * (s[eq1] - sat_a) * (s[eq1] - sat_a) : 0;
        out.field_current =
            s[eq1] + saturated +
            (xd - xd1) * (out.id - (xd1 - x2) / std::pow(xd1 - xl, 2) * (s[psi1d] + (xd1 - xl) * out.id - s[eq1]));
        return out;
    }
    /// Slopes of the rotor for the field voltage `efd`.
    template <class State>
    void motion(State const& s, Stator const& o, double efd, State& d) const {
        d[eq1] = (efd - o.field_current) / td01;
        d[psi1d] = -(s[psi1d] + (xd1 - xl) * o.id - s[eq1]) / td02;
        d[psi2q] = -(s[psi2q] + (xq - xl) * o.iq) / tq02;
        d[speed] = (p_ref / (1 + s[speed]) - o.torque) / (2 * h);
        d[angle] = kOmega * s[speed];
    }
    /// The steady state that gives `power` at a terminal voltage of angle 0; returns the field voltage.
    template <class State>
    double begin(State& x, double v, Phasor power) {
        Phasor const i = std::conj(power / v), along = v + Phasor{ra, xq} * i;
        source = v - Phasor{kR, kX} * i;
        x[angle] = std::arg(along);
        Phasor const dq = i * std::polar(1.0, std::numbers::pi / 2 - x[angle]);
        x[eq1] = std::abs(along) - (xq - xd1) * dq.real();
        x[psi1d] = x[eq1] - (xd1 - xl) * dq.real();
        x[psi2q] = -(xq - xl) * dq.imag();
        Stator const o = stator(x);
        p_ref = o.torque;
        return o.field_current;
    }
};

/// Fourth-order Runge-Kutta over `seconds`; `limit` puts the state back into its limits after each step.
template <class State, class Slope, class Limit>
void runge_kutta(State& x, double seconds, double step, Slope const& slope, Limit const& limit) {
    auto const along = [](State s, State const& d, double by) {
        for (std::size_t i = 0; i < s.size(); ++i) {
            s[i] += by * d[i];
        }
        return s;
    };
    for (std::int64_t n = std::llround(seconds / step); n > 0; --n) {
        State const a = slope(x), b = slope(along(x, a, step / 2)), c = slope(along(x, b, step / 2)),
                    d = slope(along(x, c, step));
        for (auto const& [k, weight] : {std::pair{a, 1.0}, {b, 2.0}, {c, 2.0}, {d, 1.0}}) {
            x = along(x, k, weight * step / 6);
        }
        limit(x);
    }
}

struct Change {
    std::string key;
    double value;
    double seconds;
};

/// Changes of what the machine is asked for, and what it does beside `oracle`, which has begin_at(v, power),
/// advance(seconds), stator(x) and field_voltage(x).
template <class Oracle>
void compare(std::string const& solver, std::string const& network, Oracle oracle, std::vector<Change> const& changes) {
    Network n;
    auto const diagnostics = read_text(network, n);
    ASSERT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    auto const sut = make(solver, n, kSteps);
    must(sut->initialise());
    bool const waveform = solver == "emt";
    oracle.begin_at(read(*sut, "machine.M.v_pu"),
                    {read(*sut, "machine.M.p_kw") / 100, read(*sut, "machine.M.q_kvar") / 100});
    double p_kw = 70, v_pu = 1, worst_v = 0, worst_efd = 0, worst_hz = 0;
    SimTime now;
    for (Change const& change : changes) {
        must(sut->apply(SetParameter{"machines.M." + change.key, change.value}));
        if (change.key == "p_kw") {
            oracle.p_ref += (change.value - p_kw) / 100;
            p_kw = change.value;
        } else {
            oracle.v_ref += change.value - v_pu;
            v_pu = change.value;
        }
        for (double t = 0.05; t < change.seconds; t += 0.05) {
            now = now + kSteps.nearest(Rational{1, 20});
            must(sut->advance(now));
            oracle.advance(0.05);
            double const v = read(*sut, "machine.M.v_pu") - oracle.stator(oracle.x).v;
            double const efd = read(*sut, "machine.M.efd_pu") - oracle.field_voltage(oracle.x);
            double const hz = read(*sut, "machine.M.frequency_hz") - 60 * (1 + oracle.x[Oracle::speed]);
            std::string const when = fmt::format("{}, {} = {}, after {:.2f} s", solver, change.key, change.value, t);
            ASSERT_NEAR(v, 0, waveform ? 4e-3 : 2e-4) << when;
            ASSERT_NEAR(efd, 0, waveform ? 0.1 : 0.01) << when;
            ASSERT_NEAR(hz, 0, waveform ? 0.01 : 0.001) << when;
            worst_v = std::max(worst_v, std::abs(v));
            worst_efd = std::max(worst_efd, std::abs(efd));
            worst_hz = std::max(worst_hz, std::abs(hz));
        }
    }
    testing::Test::RecordProperty("worst_v_pu", fmt::format("{:.2g}", worst_v));
    testing::Test::RecordProperty("worst_efd_pu", fmt::format("{:.2g}", worst_efd));
    testing::Test::RecordProperty("worst_hz", fmt::format("{:.2g}", worst_hz));
}

} // namespace gridspace::sim::machine_oracle
