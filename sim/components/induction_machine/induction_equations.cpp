// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/induction_machine/induction_equations.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim::induction {
namespace {

/// Below this voltage (p.u.) there is nothing to turn it.
constexpr double kDead = 0.01;
/// Speed (p.u.) in which the torque of a driven load falls to 0 and turns its sign.
constexpr double kStandstill = 0.005;

} // namespace

Machine::Machine(InductionMachine const& data)
    : name_{data.name.name}, rating_kva_{data.rating_kva}, load_{data.load_kw / data.rating_kva},
      exponent_{data.load_exponent}, h_{data.inertia_h_s}, rs_{data.pu.rs}, xs_{data.pu.xs}, xm_{data.pu.xm},
      running_{data.running} {
    cage_[0] = data.pu.cage;
    if (data.pu.second_cage) {
        cage_[1] = *data.pu.second_cage;
        cages_ = 2;
    }
    double sum = 1 / xm_;
    for (std::size_t k = 0; k < cages_; ++k) {
        sum += 1 / cage_[k].x;
    }
    xm2_ = 1 / sum;
}

Complex Machine::inductance(double slip) const {
    Complex sum = 1 / xm_;
    for (std::size_t k = 0; k < cages_; ++k) {
        sum += slip / Complex{slip * cage_[k].x, -cage_[k].r};
    }
    return xs_ + 1.0 / sum;
}

double Machine::torque(double slip, double v, double speed) const {
    Complex const l = inductance(slip);
    return -l.imag() * v * v / std::norm(rs_ + Complex{0, speed} * l);
}

double Machine::load(double w) const {
    double const size = load_ * std::pow(std::abs(w), exponent_);
    return load_ > 0 ? size * std::tanh(w / kStandstill) : size;
}

Operation Machine::operation(double v, double speed) const {
    if (load_ == 0) {
        return {};
    }
    double const side = load_ > 0 ? 1 : -1;
    auto const short_of = [&](double s) { return side * surplus(side * s, v, speed) < 0; };
    constexpr double kFirst = 1e-6, kRatio = 1.15;
    double low = 0, best = kFirst;
    for (double s = kFirst; s < 1; s *= kRatio) {
        if (!short_of(s)) {
            double high = s;
            for (int i = 0; i < 60 && high > low; ++i) {
                double const middle = (low + high) / 2;
                (short_of(middle) ? low : high) = middle;
            }
            return {side * high, true};
        }
        low = s;
        best = side * surplus(side * s, v, speed) > side * surplus(side * best, v, speed) ? s : best;
    }
    // Its peak, between the neighbours of the best that was tried.
    double a = best / kRatio, b = best * kRatio;
    for (int i = 0; i < 60; ++i) {
        double const c = a + (b - a) / 3, d = b - (b - a) / 3;
        (side * surplus(side * c, v, speed) < side * surplus(side * d, v, speed) ? a : b) =
            side * surplus(side * c, v, speed) < side * surplus(side * d, v, speed) ? c : d;
    }
    double const peak = side * (a + b) / 2;
    return {peak, side * surplus(peak, v, speed) >= 0};
}

State Machine::steady_state(Complex v, double speed) const {
    State x{};
    if (!running_ || std::abs(v) < kDead) {
        return x;
    }
    double const slip = operation(std::abs(v), speed).slip;
    x[kSpeed] = 1 - slip;
    Complex const i = v / impedance(slip, speed);
    Complex const air_gap = (inductance(slip) - xs_) * i;
    for (std::size_t k = 0; k < cages_; ++k) {
        // 0 = -r i_k - j s psi_k with psi_k = psi_m + x_k i_k
        Complex const own = Complex{0, -slip} * air_gap / Complex{cage_[k].r, slip * cage_[k].x};
        Complex const psi = air_gap + cage_[k].x * own;
        x[kFlux + 2 * k] = psi.real();
        x[kFlux + 2 * k + 1] = psi.imag();
    }
    return x;
}

Complex Machine::flux(State const& x) const {
    Complex sum;
    for (std::size_t k = 0; k < cages_; ++k) {
        sum += cage_flux(x, k) / cage_[k].x;
    }
    return xm2_ * sum;
}

void Machine::derivative(State const& x, Complex i, double w0, State& dx) const {
    Complex const behind = flux(x), air_gap = xm2_ * i + behind;
    double const slip = 1 - x[kSpeed];
    for (std::size_t k = 0; k < cages_; ++k) {
        Complex const psi = cage_flux(x, k);
        Complex const slope =
            w0 * (-cage_[k].r / cage_[k].x * (psi - air_gap) + slip * Complex{psi.imag(), -psi.real()});
        dx[kFlux + 2 * k] = slope.real();
        dx[kFlux + 2 * k + 1] = slope.imag();
    }
    dx[kSpeed] = (torque(x, i) - load(x[kSpeed])) / (2 * h_);
}

Result<void> Machine::check_start(double v) const {
    if (!running_ || v < kDead) {
        return {};
    }
    Operation const at = operation(v);
    if (at.carries) {
        return {};
    }
    return fail(
        ExitCode::usage,
        fmt::format(
            "induction machine '{}' cannot start running: at {:.3f} p.u. of voltage its breakdown torque is that of "
            "{:.4g} kW, and its load is {:.4g} kW",
            name_, v, torque(at.slip, v) * rating_kva_, load_ * rating_kva_),
        "a smaller load, a stiffer network, or `state: stopped`");
}

std::vector<SignalDef> signals() {
    return {{"speed_pu", "p.u."}, {"torque_pu", "p.u."}, {"current_pu", "p.u."}};
}

double signal(std::size_t index, Machine const& machine, State const& x, Complex i) {
    return index == 0 ? x[kSpeed] : index == 1 ? machine.torque(x, i) : std::abs(i);
}

} // namespace gridspace::sim::induction
