// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/distance.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::relay {
namespace {

/// Of the positive sequence: less zero sequence than this is an error of measurement, not a fault to earth.
constexpr double kResidualShare = 0.08;
constexpr std::array<std::uint8_t, 6> kPhasesOfLoop{1, 2, 4, 3, 6, 5};

} // namespace

Pdis::Pdis(PdisParams const& params)
    : params_{params}, turn_{elementary::cos(params.angle_deg * std::numbers::pi / 180),
                             elementary::sin(params.angle_deg * std::numbers::pi / 180)},
      confirm_{samples_of(params.confirm_s, params.rate_hz)}, delay_{samples_of(params.delay_s, params.rate_hz)} {
    reach_ = params.reach_ohm * turn_;
}

void Pdis::reset() {
    confirm_.reset();
    delay_.reset();
}

std::uint8_t Pdis::loops(Measurement const& m) const {
    double const zero = magnitude(m.i_sequence.zero);
    bool const to_earth =
        3 * zero > params_.minimum_residual_a && zero > kResidualShare * magnitude(m.i_sequence.positive);
    if (!to_earth) {
        return 0b111000;
    }
    // In phase with I0 when a is the odd one; of b and c the same, turned by a third.
    std::array<Complex, 3> const negative{m.i_sequence.negative, kTurn * m.i_sequence.negative,
                                          kTurnBack * m.i_sequence.negative};
    std::size_t odd = 0;
    double best = -1;
    for (std::size_t p = 0; p < 3; ++p) {
        double const along = (negative[p] * std::conj(m.i_sequence.zero)).real();
        if (p == 0 || along > best) {
            odd = p;
            best = along;
        }
    }
    return static_cast<std::uint8_t>((1U << odd) | (1U << (3 + (odd + 1) % 3)));
}

Pdis::Loop Pdis::loop_of(Measurement const& m, std::size_t number, Complex k0) {
    std::array<Complex, 3> const polarising{m.polarising, kTurnBack * m.polarising, kTurn * m.polarising};
    if (number < 3) {
        return {m.v[number], m.i[number] + k0 * 3.0 * m.i_sequence.zero, polarising[number], true};
    }
    std::size_t const one = number - 3, other = (number - 2) % 3;
    return {m.v[one] - m.v[other], m.i[one] - m.i[other], polarising[one] - polarising[other], false};
}

bool Pdis::is_within(Loop const& loop) const {
    if (!(magnitude(loop.i) > params_.minimum_a)) {
        return false;
    }
    Complex const i = params_.forward ? loop.i : -loop.i;
    if (params_.characteristic == PdisParams::Characteristic::mho) {
        return ((i * reach_ - loop.v) * std::conj(loop.polarising)).real() > 0;
    }
    if (!((i * turn_ * std::conj(loop.polarising)).real() > 0)) {
        return false; // behind
    }
    Complex const z = loop.v / i;
    double const beside = z.real() - z.imag() * turn_.real() / turn_.imag();
    return z.imag() < reach_.imag() && std::fabs(beside) < (loop.to_earth ? params_.r_earth_ohm : params_.r_ohm);
}

std::span<MeasuredQuantity const> Pdis::quantities() const {
    static constexpr std::array<MeasuredQuantity, 12> kLoops{{{"r_ohm.a", "ohm"},
                                                              {"r_ohm.b", "ohm"},
                                                              {"r_ohm.c", "ohm"},
                                                              {"r_ohm.ab", "ohm"},
                                                              {"r_ohm.bc", "ohm"},
                                                              {"r_ohm.ca", "ohm"},
                                                              {"x_ohm.a", "ohm"},
                                                              {"x_ohm.b", "ohm"},
                                                              {"x_ohm.c", "ohm"},
                                                              {"x_ohm.ab", "ohm"},
                                                              {"x_ohm.bc", "ohm"},
                                                              {"x_ohm.ca", "ohm"}}};
    return kLoops;
}

void Pdis::measure(Measurement const& m, std::span<double> out) const {
    std::uint8_t const counted = loops(m);
    for (std::size_t n = 0; n < 6; ++n) {
        Loop const loop = loop_of(m, n, params_.k0);
        bool const is_seen = (counted & (1U << n)) != 0 && magnitude(loop.i) > std::max(params_.minimum_a, 1e-9);
        Complex const z = is_seen ? loop.v / loop.i : Complex{std::nan(""), std::nan("")};
        out[n] = z.real();
        out[6 + n] = z.imag();
    }
}

FunctionState Pdis::step(FunctionInput const& input) {
    std::uint8_t const counted = loops(input.measured);
    std::uint8_t phases = 0;
    for (std::size_t n = 0; n < 6; ++n) {
        if ((counted & (1U << n)) != 0 && is_within(loop_of(input.measured, n, params_.k0))) {
            phases |= kPhasesOfLoop[n];
        }
    }
    FunctionState out;
    out.str = confirm_.step(phases != 0);
    out.phases = out.str ? phases : std::uint8_t{0};
    out.op = delay_.step(out.str);
    return out;
}

} // namespace gridspace::relay
