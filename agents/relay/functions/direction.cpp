// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/direction.hpp"

#include "common/elementary.hpp"

#include <numbers>

namespace gridspace::relay {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

} // namespace

Rdir::Rdir(RdirParams const& params)
    : params_{params}, turn_{elementary::cos(params.characteristic_angle_deg * kRadians),
                             elementary::sin(params.characteristic_angle_deg * kRadians)},
      least_cosine_{elementary::cos(params.sector_deg * kRadians)} {}

std::uint8_t Rdir::needs() const {
    return params_.polarisation == Polarisation::positive_sequence ? kCurrents | kVoltages | kPolarising
                                                                   : kCurrents | kVoltages;
}

/// 1: forward, -1: reverse, 0: neither.
int Rdir::side(Complex current, Complex voltage) const {
    double const i = magnitude(current), v = magnitude(voltage);
    if (!(i > params_.minimum_a) || !(v > params_.minimum_v)) {
        return 0;
    }
    double const cosine = (current * turn_ * std::conj(voltage)).real() / (i * v);
    return cosine > least_cosine_ ? 1 : cosine < -least_cosine_ ? -1 : 0;
}

FunctionState Rdir::step(FunctionInput const& input) {
    Measurement const& m = input.measured;
    std::array<int, 3> sides{};
    switch (params_.polarisation) {
    case Polarisation::positive_sequence:
        sides.fill(side(m.i_sequence.positive, m.polarising));
        break;
    case Polarisation::negative_sequence:
        sides.fill(side(m.i_sequence.negative, -m.v_sequence.negative));
        break;
    case Polarisation::zero_sequence:
        sides.fill(side(m.i_sequence.zero, -m.v_sequence.zero));
        break;
    case Polarisation::cross:
        for (std::size_t p = 0; p < 3; ++p) {
            sides[p] = side(m.i[p], Complex{0, 1} * (m.v[(p + 1) % 3] - m.v[(p + 2) % 3]));
        }
        break;
    }
    FunctionState out;
    for (std::size_t p = 0; p < 3; ++p) {
        auto const bit = static_cast<std::uint8_t>(1U << p);
        out.forward = static_cast<std::uint8_t>(out.forward | (sides[p] > 0 ? bit : 0U));
        out.reverse = static_cast<std::uint8_t>(out.reverse | (sides[p] < 0 ? bit : 0U));
    }
    out.phases = out.forward;
    out.str = out.forward != 0;
    return out;
}

} // namespace gridspace::relay
