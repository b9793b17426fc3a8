// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/synchrocheck.hpp"

#include "common/elementary.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::relay {

Rsyn::Rsyn(RsynParams const& params)
    : params_{params}, least_cosine_{elementary::cos(params.difference_deg * std::numbers::pi / 180)},
      angles_(static_cast<std::size_t>(params.samples_per_cycle)), hold_{samples_of(params.hold_s, params.rate_hz)} {}

void Rsyn::reset() {
    seen_ = 0;
    hold_.reset();
}

/// Both are live. The slip is what their angle gains in a cycle.
bool Rsyn::is_synchronous(Complex line, Complex bus) {
    Complex const apart = line * std::conj(bus);
    Complex& oldest = angles_[next_];
    next_ = next_ + 1 == angles_.size() ? 0 : next_ + 1;
    Complex const gained = apart * std::conj(oldest);
    oldest = apart;
    if (seen_ < params_.samples_per_cycle) {
        ++seen_;
        return false;
    }
    double const slip_hz =
        params_.nominal_hz * elementary::atan2(gained.imag(), gained.real()) / (2 * std::numbers::pi);
    return std::fabs(magnitude(line) - magnitude(bus)) < params_.difference_v &&
           apart.real() > least_cosine_ * magnitude(apart) && std::fabs(slip_hz) < params_.difference_hz;
}

FunctionState Rsyn::step(FunctionInput const& input) {
    Complex const line = input.measured.v_sequence.positive;
    Complex const bus = sequence_of(input.measured.bus_v).positive;
    double const at_line = magnitude(line), at_bus = magnitude(bus);
    bool const live_line = at_line > params_.live_v, live_bus = at_bus > params_.live_v;
    bool released = false;
    if (live_line && live_bus) {
        released = is_synchronous(line, bus);
    } else {
        seen_ = 0;
        released = (params_.dead_line && live_bus && at_line < params_.dead_v) ||
                   (params_.dead_bus && live_line && at_bus < params_.dead_v);
    }
    FunctionState out;
    out.str = released;
    out.op = hold_.step(released);
    return out;
}

} // namespace gridspace::relay
