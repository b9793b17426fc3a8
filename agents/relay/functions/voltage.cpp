// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/voltage.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::relay {

VoltageFunction::VoltageFunction(VoltageParams const& params)
    : params_{params}, delay_{samples_of(params.delay_s, params.rate_hz)} {}

void VoltageFunction::reset() {
    delay_.reset();
    started_ = {};
    travelled_ = 0;
}

Abc VoltageFunction::measured(Measurement const& m, std::size_t& count) const {
    count = 3;
    switch (params_.measures) {
    case VoltageOf::phase_to_phase:
        return {magnitude(m.v[0] - m.v[1]), magnitude(m.v[1] - m.v[2]), magnitude(m.v[2] - m.v[0])};
    case VoltageOf::positive_sequence:
        count = 1;
        return {magnitude(m.v_sequence.positive), 0, 0};
    case VoltageOf::residual:
        count = 1;
        return {3 * magnitude(m.v_sequence.zero), 0, 0};
    case VoltageOf::phase_to_earth:
        break;
    }
    return magnitudes(m.v);
}

bool VoltageFunction::is_beyond(double v, bool started) const {
    if (params_.over) {
        return v > params_.pickup_v * (started ? params_.dropout_ratio : 1);
    }
    return v < params_.pickup_v / (started ? params_.dropout_ratio : 1);
}

FunctionState VoltageFunction::step(FunctionInput const& input) {
    std::size_t count = 0;
    Abc const v = measured(input.measured, count);
    FunctionState out;
    std::size_t beyond = 0;
    double farthest = 0, highest = 0;
    for (std::size_t p = 0; p < count; ++p) {
        started_[p] = is_beyond(v[p], started_[p]);
        highest = std::max(highest, v[p]);
        if (started_[p]) {
            ++beyond;
            out.phases = static_cast<std::uint8_t>(out.phases | (1U << p));
            double const ratio = v[p] / params_.pickup_v;
            farthest = std::max(farthest, params_.over ? ratio - 1 : 1 - ratio);
        }
    }
    bool const off = !params_.over && highest < params_.block_below_v;
    out.str = !off && (params_.all_phases ? beyond == count : beyond > 0);
    if (!out.str) {
        out.phases = 0;
        delay_.reset();
        travelled_ = 0;
        return out;
    }
    if (params_.inverse) {
        travelled_ = std::min(travelled_ + farthest / (params_.time_multiplier * params_.rate_hz), 1.0);
        out.op = travelled_ >= 1;
    } else {
        out.op = delay_.step(true);
    }
    return out;
}

} // namespace gridspace::relay
