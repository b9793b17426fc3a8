// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/marti.hpp"

#include "sim/circuit/space.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

/// (1 - exp(-a)) / a
double mean_of_decay(double a) {
    return a == 0 ? 1 : -std::expm1(-a) / a;
}

/// (1 - mean_of_decay(a)) / a
double ramp_of_decay(double a) {
    if (a > 0.1) {
        return (1 - mean_of_decay(a)) / a;
    }
    double sum = 0, term = 0.5; // (-a)^n / (n + 2)!
    for (int n = 0; n < 10; ++n) {
        sum += term;
        term *= -a / (n + 3);
    }
    return sum;
}

std::array<double, 3> modes_of(double const* phases) {
    Space const s = to_space(phases[0], phases[1], phases[2]);
    return {s.alpha, s.beta, s.zero};
}

std::array<Complex, 3> modes_of(std::array<Complex, 3> const& phases) {
    double real[3], imaginary[3];
    for (std::size_t k = 0; k < 3; ++k) {
        real[k] = phases[k].real();
        imaginary[k] = phases[k].imag();
    }
    auto const re = modes_of(real), im = modes_of(imaginary);
    return {Complex{re[0], im[0]}, Complex{re[1], im[1]}, Complex{re[2], im[2]}};
}

/// What the terms will be without the newest input, added up.
double without_newest(PoleRecursion const& r, std::vector<double> const& terms, double last) {
    double sum = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
        sum += r.decay[k] * terms[k] + r.past[k] * last;
    }
    return sum;
}

/// Takes the step; returns the sum.
double next_terms(PoleRecursion const& r, std::vector<double>& terms, double last, double newest) {
    double sum = r.direct * newest;
    for (std::size_t k = 0; k < terms.size(); ++k) {
        terms[k] = r.decay[k] * terms[k] + r.past[k] * last + r.fresh[k] * newest;
        sum += terms[k];
    }
    return sum;
}

} // namespace

PoleRecursion PoleRecursion::straight(PoleSum const& f, double h) {
    PoleRecursion out{f.constant, {}, {}, {}};
    for (std::size_t k = 0; k < f.poles.size(); ++k) {
        double const a = f.poles[k] * h, fresh = ramp_of_decay(a);
        out.decay.push_back(std::exp(-a));
        out.fresh.push_back(f.residues[k] * h * fresh);
        out.past.push_back(f.residues[k] * h * (mean_of_decay(a) - fresh));
    }
    return out;
}

PoleRecursion PoleRecursion::damped_half(PoleSum const& f, double h) {
    PoleRecursion out = straight(f, h);
    for (std::size_t k = 0; k < f.poles.size(); ++k) {
        double const a = f.poles[k] * h;
        out.decay[k] = std::exp(-a / 2);
        out.past[k] = f.residues[k] * h * (mean_of_decay(a / 2) / 2 - ramp_of_decay(a));
    }
    return out;
}

double PoleRecursion::gain() const {
    double sum = direct;
    for (double const x : fresh) {
        sum += x;
    }
    return sum;
}

Complex PoleRecursion::at(double w, double h) const {
    Complex const back = std::polar(1.0, -w * h);
    Complex sum{direct};
    for (std::size_t k = 0; k < decay.size(); ++k) {
        sum += (fresh[k] + past[k] * back) / (1.0 - decay[k] * back);
    }
    return sum;
}

MartiStep::MartiStep(MartiLine const& line, double h) {
    auto const of = [&](MartiLine::Mode const& m) {
        Mode out{PoleRecursion::straight(m.impedance, h), PoleRecursion::damped_half(m.impedance, h),
                 PoleRecursion::straight(m.propagation, h), PoleRecursion::straight(m.propagation, h / 2), 0};
        out.gain = out.impedance.gain();
        return out;
    };
    modes = {of(line.positive), of(line.zero)};
}

PhaseMatrix MartiStep::conductance() const {
    return PhaseMatrix::sequence(1 / modes[0].gain, 1 / modes[1].gain);
}

MartiWaves::MartiWaves(MartiLine const& line, double step_s)
    : tau_{line.positive.tau_s, line.positive.tau_s, line.zero.tau_s}, step_s_{step_s} {
    for (auto& end : now_) {
        for (std::size_t m = 0; m < 3; ++m) {
            MartiLine::Mode const& mode = m == 2 ? line.zero : line.positive;
            end[m].impedance.assign(mode.impedance.poles.size(), 0.0);
            end[m].propagation.assign(mode.propagation.poles.size(), 0.0);
        }
    }
    saved_ = now_;
    // Events cut steps: more entries than a travel time has steps, with room for many of them.
    past_ = {4 * static_cast<std::size_t>(std::ceil(std::max(tau_[0], tau_[2]) / step_s)) + 256, step_s};
    past_.next() = {};
}

/// The travel time, with straight lines between what left at two steps.
Complex MartiWaves::travel(std::size_t mode, double w) const {
    double const steps = tau_[mode] / step_s_, whole = std::floor(steps), share = steps - whole;
    return std::polar(1.0, -w * step_s_ * whole) * (1 - share + share * std::polar(1.0, -w * step_s_));
}

MartiWaves::Steady MartiWaves::steady(MartiStep const& step, double w) const {
    auto const mode = [&](std::size_t sequence, std::size_t m) {
        Complex const z = step.modes[sequence].impedance.at(w, step_s_),
                      a = step.modes[sequence].propagation.at(w, step_s_) * travel(m, w);
        return std::pair{(1.0 + a * a) / (z * (1.0 - a * a)), -2.0 * a / (z * (1.0 - a * a))};
    };
    auto const [own1, cross1] = mode(0, 0);
    auto const [own0, cross0] = mode(1, 2);
    return {ComplexPhaseMatrix::sequence(own1, own0), ComplexPhaseMatrix::sequence(cross1, cross0)};
}

void MartiWaves::start(MartiStep const& step, double w, Phasors const& v, Phasors const& i) {
    Complex const back = std::polar(1.0, -w * step_s_);
    auto const fill = [&](PoleRecursion const& r, Complex input, std::vector<double>& terms) {
        Complex sum = r.direct * input;
        for (std::size_t k = 0; k < terms.size(); ++k) {
            Complex const term = input * (r.fresh[k] + r.past[k] * back) / (1.0 - r.decay[k] * back);
            terms[k] = term.real();
            sum += term;
        }
        return sum;
    };
    std::array<std::array<Complex, 3>, 2> g{};
    for (std::size_t end = 0; end < 2; ++end) {
        auto const volts = modes_of(v[end]), amperes = modes_of(i[end]);
        for (std::size_t m = 0; m < 3; ++m) {
            MartiStep::Mode const& mode = step.modes[m == 2 ? 1 : 0];
            End& e = now_[end][m];
            Complex const f = volts[m] + fill(mode.impedance, amperes[m], e.impedance);
            g[end][m] = fill(mode.propagation, f, e.propagation);
            e.i = amperes[m].real();
            e.f = f.real();
        }
    }
    past_.clear();
    std::size_t const count = past_.size();
    for (std::size_t n = 0; n < count; ++n) {
        double const t = -static_cast<double>(count - 1 - n) * step_s_;
        Complex const turn = std::polar(1.0, w * t);
        Wave& wave = past_.next();
        wave.t = t;
        for (std::size_t end = 0; end < 2; ++end) {
            for (std::size_t m = 0; m < 3; ++m) {
                wave.g[end][m] = (g[end][m] * turn).real();
            }
        }
    }
}

void MartiWaves::history(MartiStep const& step, Rule rule, double t, std::size_t end, double* out) {
    std::array<double, 3> amperes{};
    for (std::size_t m = 0; m < 3; ++m) {
        auto const [older, newer, share] = past_.around(t - tau_[m]);
        double const a = older.g[1 - end][m], b = newer.g[1 - end][m];
        arriving_[end][m] = a + share * (b - a);
        MartiStep::Mode const& mode = step.modes[m == 2 ? 1 : 0];
        PoleRecursion const& r = rule == Rule::trapezoid ? mode.impedance : mode.impedance_half;
        End const& e = now_[end][m];
        amperes[m] = -(without_newest(r, e.impedance, e.i) + arriving_[end][m]) / mode.gain;
    }
    auto const phases = to_phases({amperes[0], amperes[1], amperes[2]});
    std::copy(phases.begin(), phases.end(), out);
}

void MartiWaves::leave(MartiStep const& step, Rule rule, std::size_t end, double const* v, double const* i) {
    bool const whole = rule == Rule::trapezoid;
    Wave& wave = past_.newest();
    auto const volts = modes_of(v), amperes = modes_of(i);
    for (std::size_t m = 0; m < 3; ++m) {
        MartiStep::Mode const& mode = step.modes[m == 2 ? 1 : 0];
        End& e = now_[end][m];
        (void)next_terms(whole ? mode.impedance : mode.impedance_half, e.impedance, e.i, amperes[m]);
        e.i = amperes[m];
        double const f = 2 * volts[m] - arriving_[end][m];
        wave.g[end][m] = next_terms(whole ? mode.propagation : mode.propagation_half, e.propagation, e.f, f);
        e.f = f;
    }
}

void MartiWaves::save() {
    saved_ = now_;
    mark_ = past_.mark();
}

void MartiWaves::restore() {
    now_ = saved_;
    past_.back_to(mark_);
}

} // namespace gridspace::sim::emt
