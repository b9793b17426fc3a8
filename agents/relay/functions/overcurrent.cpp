// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/overcurrent.hpp"

#include <algorithm>

namespace gridspace::relay {

Abc current_of(CurrentOf what, Measurement const& m) {
    switch (what) {
    case CurrentOf::residual:
        return {3 * magnitude(m.i_sequence.zero), 0, 0};
    case CurrentOf::negative_sequence:
        return {magnitude(m.i_sequence.negative), 0, 0};
    case CurrentOf::phases:
        break;
    }
    return magnitudes(m.i);
}

std::span<MeasuredQuantity const> currents_of(CurrentOf what) {
    static constexpr std::array<MeasuredQuantity, 3> kPhases{
        {{"current_a.a", "A"}, {"current_a.b", "A"}, {"current_a.c", "A"}}};
    static constexpr std::array<MeasuredQuantity, 1> kOne{{{"current_a", "A"}}};
    return what == CurrentOf::phases ? std::span<MeasuredQuantity const>{kPhases}
                                     : std::span<MeasuredQuantity const>{kOne};
}

void measure_currents(CurrentOf what, Measurement const& m, std::span<double> out) {
    Abc const current = current_of(what, m);
    std::copy_n(current.begin(), out.size(), out.begin());
}

std::uint8_t Direction::phases(FunctionInput const& input) const {
    return !of ? std::uint8_t{7} : forward ? input.others[*of].forward : input.others[*of].reverse;
}

Ptoc::Ptoc(PtocParams const& params)
    : params_{params}, delay_{samples_of(params.delay_s, params.rate_hz)},
      minimum_{samples_of(params.minimum_s, params.rate_hz)},
      reset_samples_{samples_of(params.reset_s, params.rate_hz)} {}

void Ptoc::reset() {
    phases_ = {};
}

/// One sample above the setting: whether the phase operates.
bool Ptoc::runs(Phase& phase, double current_a) const {
    phase.below = 0;
    ++phase.since;
    if (params_.curve == Curve::definite_time) {
        phase.travelled = phase.since > delay_ ? 1 : 0;
        return phase.travelled >= 1;
    }
    double const time_s = params_.time_multiplier * operate_time_s(params_.curve, current_a / params_.pickup_a);
    phase.travelled = std::min(phase.travelled + 1 / (time_s * params_.rate_hz), 1.0);
    return phase.travelled >= 1 && phase.since > minimum_;
}

/// One sample below it.
void Ptoc::rests(Phase& phase, double current_a) const {
    using Reset = PtocParams::Reset;
    switch (params_.reset) {
    case Reset::instantaneous:
        phase = {};
        return;
    case Reset::definite_time:
        if (++phase.below > reset_samples_) {
            phase = {};
        }
        return;
    case Reset::dependent:
        double const time_s = params_.time_multiplier * reset_time_s(params_.curve, current_a / params_.pickup_a);
        phase.travelled = std::max(phase.travelled - 1 / (time_s * params_.rate_hz), 0.0);
        phase.since = phase.travelled > 0 ? phase.since : 0;
        return;
    }
}

FunctionState Ptoc::step(FunctionInput const& input) {
    Abc const current = current_of(params_.measures, input.measured);
    std::uint8_t const allowed = params_.direction.phases(input);
    FunctionState out;
    for (std::size_t p = 0; p < 3; ++p) {
        Phase& phase = phases_[p];
        auto const bit = static_cast<std::uint8_t>(1U << p);
        double const threshold = params_.pickup_a * (phase.started ? params_.dropout_ratio : 1);
        phase.started = (allowed & bit) != 0 && current[p] > threshold;
        if (!phase.started) {
            rests(phase, current[p]);
            continue;
        }
        out.str = true;
        out.phases |= bit;
        out.op = runs(phase, current[p]) || out.op;
    }
    return out;
}

FunctionState Pioc::step(FunctionInput const& input) {
    Abc const current = current_of(params_.measures, input.measured);
    std::uint8_t const allowed = params_.direction.phases(input);
    FunctionState out;
    for (std::size_t p = 0; p < 3; ++p) {
        auto const bit = static_cast<std::uint8_t>(1U << p);
        double const threshold = params_.pickup_a * (confirmed_[p] > 0 ? params_.dropout_ratio : 1);
        bool const on = (allowed & bit) != 0 && current[p] > threshold;
        confirmed_[p] = on ? std::min(confirmed_[p] + 1, params_.confirm_samples) : 0;
        out.str = out.str || on;
        out.phases = static_cast<std::uint8_t>(out.phases | (on ? bit : 0U));
        out.op = out.op || (on && confirmed_[p] >= params_.confirm_samples);
    }
    return out;
}

} // namespace gridspace::relay
