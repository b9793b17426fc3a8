// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>

/// WSCC 9-bus with classical machines, written down a second time and independently of all solvers: space vectors in a
/// frame that turns at 60 Hz, the network's own differential equations (machine and transformer, lines, their charging,
/// loads), classical Runge-Kutta. p.u. on 100 MVA; currents of the bolted fault at bus 7 end at once with line 5-7.
namespace gridspace::wscc9 {

using Complex = std::complex<double>;
constexpr double kW0 = 2 * std::numbers::pi * 60, kZBase = 529;
constexpr Complex kJ{0, 1};

struct LineData {
    std::size_t from, to; ///< bus number less 4
    double r_ohm, x_ohm, c_nf;
};
constexpr std::array<LineData, 6> kLines{{{0, 1, 5.29, 44.965, 882.52268},
                                          {0, 2, 8.993, 48.668, 792.26468},
                                          {1, 3, 16.928, 85.169, 1534.386},
                                          {2, 5, 20.631, 89.93, 1795.1314},
                                          {3, 4, 4.4965, 38.088, 747.13568},
                                          {4, 5, 6.2951, 53.3232, 1047.9957}}};
constexpr std::size_t kTripped = 2, kFaulted = 3; ///< line 5-7, bus 7
/// xd' and transformer, inertia, terminal of the transformer, internal voltage and its angle [Anderson and Fouad,
/// example 2.6].
constexpr std::array<double, 3> kX{0.0608 + 0.0576, 0.1198 + 0.0625, 0.1813 + 0.0586}, kH{23.64, 6.4, 3.01},
    kE{1.0566, 1.0502, 1.0170}, kDegrees{2.2717, 19.7315, 13.1752};
constexpr std::array<std::size_t, 3> kTerminal{0, 3, 5}, kLoadBus{1, 2, 4};
constexpr std::array<double, 3> kLoadP{1.2609945, 0.87764795, 0.96897509}, kLoadQ{0.5043978, 0.29254932, 0.33914128};

enum class Stage { before, fault, after };

/// A vector with the arithmetic that Runge-Kutta needs: 6 lines, 3 machines, 3 loads (currents), 6 voltages.
struct State {
    std::array<Complex, 18> x{};
    std::array<double, 3> angle{}, speed{}; ///< rad; deviation, p.u.
    [[nodiscard]] State plus(double h, State const& d) const {
        State out = *this;
        for (std::size_t i = 0; i < x.size(); ++i) {
            out.x[i] += h * d.x[i];
        }
        for (std::size_t i = 0; i < 3; ++i) {
            out.angle[i] += h * d.angle[i];
            out.speed[i] += h * d.speed[i];
        }
        return out;
    }
    Complex& line(std::size_t i) { return x[i]; }
    Complex& machine(std::size_t i) { return x[6 + i]; }
    Complex& load(std::size_t i) { return x[9 + i]; }
    Complex& v(std::size_t i) { return x[12 + i]; }
};

class Integration {
  public:
    /// `direct_current`: false takes the currents and voltages of the fault from phasors at its begin, so that nothing
    /// of the state before it stays behind as direct current.
    explicit Integration(bool direct_current) {
        for (std::size_t k = 0; k < 3; ++k) {
            s_.angle[k] = kDegrees[k] * std::numbers::pi / 180;
        }
        steady(Stage::before);
        for (std::size_t k = 0; k < 3; ++k) {
            power_[k] = (emf(s_, k) * std::conj(s_.machine(k))).real();
        }
        if (!direct_current) {
            steady(Stage::fault);
        }
        s_.v(kFaulted) = 0;
    }

    void advance(double span_s, Stage stage) {
        constexpr double kStep = 2e-5;
        auto const steps = std::lround(std::ceil(span_s / kStep));
        double const h = span_s / static_cast<double>(steps);
        for (long n = 0; n < steps; ++n) {
            State const a = slope(s_, stage), b = slope(s_.plus(h / 2, a), stage), c = slope(s_.plus(h / 2, b), stage),
                        d = slope(s_.plus(h, c), stage);
            s_ = s_.plus(h / 6, a).plus(h / 3, b).plus(h / 3, c).plus(h / 6, d);
        }
    }
    [[nodiscard]] double speed(std::size_t machine) const { return s_.speed[machine]; }

    /// Whether the machines stay together for two seconds after clearing.
    [[nodiscard]] bool stable(double clearing_s) {
        advance(clearing_s, Stage::fault);
        s_.line(kTripped) = 0;
        for (int n = 0; n < 200; ++n) {
            advance(0.01, Stage::after);
            if (!(std::abs(s_.angle[1] - s_.angle[0]) < std::numbers::pi)) {
                return false;
            }
        }
        return true;
    }

  private:
    static Complex emf(State const& s, std::size_t k) { return std::polar(kE[k], s.angle[k]); }
    static double charging(LineData const& l) { return kW0 * l.c_nf * 1e-9 * kZBase / 2; }
    static bool in_service(std::size_t l, Stage stage) { return stage != Stage::after || l != kTripped; }

    /// All currents and voltages from phasors: Gauss elimination of the six nodes.
    void steady(Stage stage) {
        std::array<std::array<Complex, 7>, 6> a{};
        for (std::size_t l = 0; l < 6; ++l) {
            LineData const& d = kLines[l];
            Complex const y = kZBase / Complex{d.r_ohm, d.x_ohm};
            for (auto const& [i, j] : {std::pair{d.from, d.to}, {d.to, d.from}}) {
                a[i][i] += y + kJ * charging(d);
                a[i][j] -= y;
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            a[kLoadBus[k]][kLoadBus[k]] += Complex{kLoadP[k], -kLoadQ[k]};
            a[kTerminal[k]][kTerminal[k]] += 1.0 / (kJ * kX[k]);
            a[kTerminal[k]][6] += emf(s_, k) / (kJ * kX[k]);
        }
        a[kFaulted][kFaulted] += stage == Stage::fault ? 1e9 : 0;
        for (std::size_t c = 0; c < 6; ++c) { // diagonally dominant enough: no pivoting
            for (std::size_t r = 0; r < 6; ++r) {
                Complex const factor = r == c ? 0 : a[r][c] / a[c][c];
                for (std::size_t k = c; k < 7; ++k) {
                    a[r][k] -= factor * a[c][k];
                }
            }
        }
        for (std::size_t i = 0; i < 6; ++i) {
            s_.v(i) = a[i][6] / a[i][i];
        }
        for (std::size_t l = 0; l < 6; ++l) {
            LineData const& d = kLines[l];
            s_.line(l) = (s_.v(d.from) - s_.v(d.to)) * kZBase / Complex{d.r_ohm, d.x_ohm};
        }
        for (std::size_t k = 0; k < 3; ++k) {
            s_.machine(k) = (emf(s_, k) - s_.v(kTerminal[k])) / (kJ * kX[k]);
            s_.load(k) = s_.v(kLoadBus[k]) * Complex{0, -kLoadQ[k]};
        }
    }

    [[nodiscard]] State slope(State s, Stage stage) const {
        State d;
        std::array<Complex, 6> into{};
        std::array<double, 6> b{};
        for (std::size_t l = 0; l < 6; ++l) {
            if (in_service(l, stage)) {
                LineData const& data = kLines[l];
                Complex const z = Complex{data.r_ohm, data.x_ohm} / kZBase, i = s.line(l);
                d.line(l) = kW0 / z.imag() * (s.v(data.from) - s.v(data.to) - z * i);
                into[data.from] -= i;
                into[data.to] += i;
                b[data.from] += charging(data);
                b[data.to] += charging(data);
            }
        }
        for (std::size_t k = 0; k < 3; ++k) {
            std::size_t const t = kTerminal[k], n = kLoadBus[k];
            Complex const flux = emf(s, k), i = s.machine(k); // -j d(flux)/dt is the voltage
            d.machine(k) = kW0 / kX[k] * ((1 + s.speed[k]) * flux - s.v(t) - kJ * kX[k] * i);
            d.speed[k] = (power_[k] - (flux * std::conj(i)).real()) / (2 * kH[k]);
            d.angle[k] = kW0 * s.speed[k];
            d.load(k) = kW0 * kLoadQ[k] * s.v(n) - kW0 * kJ * s.load(k);
            into[t] += i;
            into[n] -= s.load(k) + kLoadP[k] * s.v(n);
        }
        for (std::size_t i = 0; i < 6; ++i) {
            bool const shorted = stage == Stage::fault && i == kFaulted;
            d.v(i) = shorted ? Complex{} : kW0 / b[i] * into[i] - kW0 * kJ * s.v(i);
        }
        return d;
    }

    State s_;
    std::array<double, 3> power_{};
};

} // namespace gridspace::wscc9
