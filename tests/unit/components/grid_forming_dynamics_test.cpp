// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// A grid-forming battery alone on a load, in waveforms, against its equations of docs/reference/components.md and the
/// circuit's, written down once more as space vectors and integrated by Runge-Kutta at 2 us.
namespace gridspace::sim {
namespace {

constexpr double kForming0 = 2 * std::numbers::pi * 60, kFormingKva = 150,
                 kFormingOhm = 480.0 * 480 / (kFormingKva * 1e3);
constexpr double kFormingRf = 0.01, kFormingXf = 0.15;                                         // of its filter, p.u.
constexpr double kFormingRl = 0.01 / kFormingOhm, kFormingXl = kForming0 * 5e-5 / kFormingOhm; // of the line

/// r and l of the load in parallel behind the line; all in p.u. of the battery, in a frame at 60 Hz.
class FormingReference {
  public:
    FormingReference(double p_kw, double q_kvar) : g_{p_kw / kFormingKva}, b_{q_kvar / kFormingKva} {
        Complex const v{1}, i = v / (Complex{kFormingRl, kFormingXl} + 1.0 / Complex{g_, -b_});
        Complex const e = v + Complex{kFormingRf, kFormingXf} * i, at_load = v - Complex{kFormingRl, kFormingXl} * i;
        p0_ = (v * std::conj(i)).real();
        q0_ = (v * std::conj(i)).imag();
        x_ = {i.real(), i.imag(), 0, 0, 0, std::arg(e), std::abs(e), q0_, 0, 0};
        set_inductance(at_load * Complex{0, -b_});
        set_measured(v * std::polar(1.0, -std::arg(e)));
    }
    void set_power(double p_kw) { g_ = p_kw / kFormingKva; }
    void advance(double span_s) {
        constexpr double kStepS = 2e-6;
        for (long n = std::lround(span_s / kStepS); n > 0; --n) {
            X const a = slope(x_), b = slope(plus(kStepS / 2, a)), c = slope(plus(kStepS / 2, b)),
                    d = slope(plus(kStepS, c));
            for (std::size_t s = 0; s < x_.size(); ++s) {
                x_[s] += kStepS / 6 * (a[s] + 2 * b[s] + 2 * c[s] + d[s]);
            }
        }
    }
    [[nodiscard]] double hz() const { return 60 * (1 + x_[4]); }
    [[nodiscard]] double emf() const { return x_[6]; }
    [[nodiscard]] double p_kw() const { return kFormingKva * (terminals(x_).v * std::conj(current(x_))).real(); }
    [[nodiscard]] double v() const { return std::abs(terminals(x_).v); }
    [[nodiscard]] double limited() const { return 1 - terminals(x_).share; }

  private:
    // current of the filter and line, of the load's inductance, speed, angle, emf, measured q, measured voltage
    using X = std::array<double, 10>;
    struct Terminals {
        Complex v, di; ///< voltage, slope of the current over w0
        double share{1};
    };
    static Complex current(X const& x) { return {x[0], x[1]}; }
    static Complex inductive(X const& x) { return {x[2], x[3]}; }
    void set_inductance(Complex i) {
        x_[2] = i.real();
        x_[3] = i.imag();
        x_[4] = 0;
    }
    void set_measured(Complex m) {
        x_[8] = m.real();
        x_[9] = m.imag();
    }
    [[nodiscard]] X plus(double h, X const& d) const {
        X out = x_;
        for (std::size_t s = 0; s < out.size(); ++s) {
            out[s] += h * d[s];
        }
        return out;
    }
    [[nodiscard]] Terminals terminals(X const& x) const {
        Complex const axis = std::polar(1.0, x[5]), i = current(x), measured{x[8], x[9]}, drive = x[6] - measured;
        double const most = 1.2 * std::abs(Complex{kFormingRf, kFormingXf}), size = std::abs(i);
        Terminals out;
        out.share = std::min(1.0, most / std::abs(drive));
        Complex e = (measured + out.share * drive) * axis;
        if (size > 1.2) { // the virtual resistance: the filter's inductance over 0.2 ms
            e -= kFormingXf / kForming0 / 2e-4 * (size - 1.2) * i / size;
        }
        Complex const at_load = (i - inductive(x)) / g_;
        out.di = (e - at_load - (kFormingRf + kFormingRl) * i) / (kFormingXf + kFormingXl);
        out.v = e - kFormingRf * i - kFormingXf * out.di;
        return out;
    }
    [[nodiscard]] X slope(X const& x) const {
        Terminals const at = terminals(x);
        Complex const i = current(x), il = inductive(x), j{0, 1}, measured{x[8], x[9]};
        Complex const di = kForming0 * (at.di - j * i), dil = kForming0 * (b_ * (i - il) / g_ - j * il);
        Complex const s = at.v * std::conj(i);
        Complex const dm = (at.v * std::polar(1.0, -x[5]) - measured) / 1e-4; // its lag of 0.1 ms
        X d{};
        d[0] = di.real();
        d[1] = di.imag();
        d[2] = dil.real();
        d[3] = dil.imag();
        d[4] = (p0_ - s.real() - x[4] / 0.02) / (2 * 0.5);
        d[5] = kForming0 * x[4];
        d[6] = 30 * (1 - 0.05 * (x[7] - q0_) - std::abs(at.v) - (1 - at.share) * std::abs(x[6] - measured));
        d[7] = (s.imag() - x[7]) / 0.02;
        d[8] = dm.real();
        d[9] = dm.imag();
        return d;
    }

    double g_, b_, p0_{0}, q0_{0};
    X x_{};
};

struct FormingWorst {
    double hz{0}, emf{0}, p_kw{0}, v{0}, limited{0}, moved_hz{0};
};

/// The load goes to so many kW for half a second, and back, in steps of 1 / (48000 finer) s; every millisecond.
FormingWorst forming_worst(double kw, int finer) {
    Network n;
    auto const diagnostics =
        read_text("gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n"
                  "buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                  "lines: {L: {from: A, to: B, r_ohm: 0.01, l_mh: 0.05}}\n"
                  "loads: {D: {bus: B, p_kw: 60, q_kvar: 20, model: constant_impedance}}\n"
                  "batteries: {G: {bus: A, capacity_kwh: 100, rating_kva: 150, control: grid_forming, p_kw: 0}}\n",
                  n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    auto const sut = make("emt", std::move(n), TimeBase{Rational{1, 48000 * finer}});
    must(sut->initialise());
    FormingReference reference{60, 20};
    FormingWorst out;
    for (int ms = 1; ms <= 1000; ++ms) {
        if (ms == 101 || ms == 601) {
            must(sut->apply(SetParameter{"loads.D.p_kw", ms == 101 ? kw : 60}));
            reference.set_power(ms == 101 ? kw : 60);
        }
        must(sut->advance(SimTime{} + SimSpan{48 * finer * ms}));
        reference.advance(1e-3);
        auto const worst = [&](double& of, char const* signal, double expected) {
            of = std::max(of, std::abs(read(*sut, signal) - expected));
        };
        worst(out.hz, "battery.G.frequency_hz", reference.hz());
        worst(out.emf, "battery.G.emf_pu", reference.emf());
        worst(out.p_kw, "battery.G.p_kw", reference.p_kw());
        worst(out.v, "bus.A.v_pu", reference.v());
        out.limited = std::max(out.limited, reference.limited());
        out.moved_hz = std::max(out.moved_hz, std::abs(reference.hz() - 60));
    }
    return out;
}

/// The step after a discontinuity extrapolates a control that knows nothing of it: an error that halves with the step.
void expect_convergence(FormingWorst const& usual, FormingWorst const& fine) {
    EXPECT_LT(fine.hz, 0.45 * usual.hz);
    EXPECT_LT(fine.emf, 0.45 * usual.emf);
    EXPECT_LT(fine.p_kw, 0.45 * usual.p_kw);
    EXPECT_LT(fine.v, 0.45 * usual.v);
}

TEST(GridFormingDynamics, OfAStepOfLoadAreThoseOfItsEquations) {
    FormingWorst const usual = forming_worst(110, 1);
    EXPECT_LT(usual.hz, 1.2e-3);
    EXPECT_LT(usual.emf, 1.2e-3);
    EXPECT_LT(usual.p_kw, 0.6);
    EXPECT_LT(usual.v, 2.5e-3);
    EXPECT_EQ(usual.limited, 0);
    EXPECT_GT(usual.moved_hz, 0.3); // negative control: it has moved
    expect_convergence(usual, forming_worst(110, 4));
}

TEST(GridFormingDynamics, OfAnOverloadBeyondItsCurrentLimitAreThoseOfItsEquations) {
    FormingWorst const usual = forming_worst(600, 1);
    EXPECT_LT(usual.hz, 0.012);
    EXPECT_LT(usual.emf, 0.012);
    EXPECT_LT(usual.p_kw, 15);
    EXPECT_LT(usual.v, 0.08);
    EXPECT_GT(usual.limited, 0.1);
    expect_convergence(usual, forming_worst(600, 4));
}

} // namespace
} // namespace gridspace::sim
