// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/bay_relay.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <numbers>

namespace gridspace::relay {
namespace {

constexpr std::array<std::uint8_t, 3> kQuantityOf{kCurrents, kVoltages, kBusVoltages};

FrequencyParams frequency_params(BayParams const& p) {
    FrequencyParams out;
    out.nominal_hz = p.frequency_hz;
    out.samples_per_cycle = p.samples_per_cycle;
    out.minimum = p.minimum_v;
    return out;
}

} // namespace

std::string_view name_of(FunctionEvent::Kind kind) {
    constexpr std::array<std::string_view, 9> kNames{"start",  "operate", "reset", "block",  "unblock",
                                                     "pickup", "dropout", "trip",  "release"};
    return kNames[static_cast<std::size_t>(kind)];
}

BayRelay::BayRelay(BayParams const& params, FunctionSet functions)
    : params_{params}, functions_{std::move(functions)},
      inputs_{Input{PhasorEstimator{{params.samples_per_cycle, params.offset_cycles * params.samples_per_cycle}}},
              Input{PhasorEstimator{{params.samples_per_cycle, 0}}},
              Input{PhasorEstimator{{params.samples_per_cycle, 0}}}},
      frequency_{frequency_params(params)},
      memory_{params.samples_per_cycle, params.minimum_v, samples_of(params.hold_s, params.rate_hz)},
      before_(functions_.states().size()), blocked_before_(functions_.states().size(), true),
      events_{params.event_capacity} {
    measured_.frequency_hz = params.frequency_hz;
}

/// Bridges a short gap; after a long one the window begins anew.
void BayRelay::take(Input& input, std::optional<Abc> const& value, std::int64_t index) {
    std::int64_t const missing = input.has_last ? index - input.last_index - 1 : 0;
    if (input.has_last && missing + (value ? 0 : 1) > params_.max_interpolated) {
        input.has_last = false;
        input.estimator.clear();
    }
    if (!value) {
        return;
    }
    for (std::int64_t k = 1; input.has_last && k <= missing; ++k) {
        double const share = static_cast<double>(k) / static_cast<double>(missing + 1);
        Abc between{};
        for (std::size_t p = 0; p < 3; ++p) {
            between[p] = input.last[p] + share * ((*value)[p] - input.last[p]);
        }
        push(input, between);
    }
    push(input, *value);
    input.last = *value;
    input.last_index = index;
    input.has_last = true;
}

void BayRelay::push(Input& input, Abc const& value) {
    input.estimator.push(value);
    if (&input == &inputs_[1]) {
        follow_voltage();
    }
}

/// Its sample is missing and may still be bridged.
bool BayRelay::is_waiting(Input const& input, std::int64_t index) const {
    return input.has_last && input.estimator.full() && input.last_index != index;
}

void BayRelay::step(BaySample const& sample) {
    if (started_ && sample.index <= index_) {
        return;
    }
    started_ = true;
    index_ = sample.index;
    follow_frequency();
    std::array<std::optional<Abc> const*, 3> const values{&sample.i_a, &sample.v_v, &sample.bus_v};
    bool waiting = false;
    for (std::size_t k = 0; k < 3; ++k) {
        if ((params_.inputs & kQuantityOf[k]) != 0) {
            take(inputs_[k], *values[k], sample.index);
            waiting = waiting || is_waiting(inputs_[k], sample.index);
        }
    }
    if (!waiting) { // phasors of one instant, or none
        measure();
    }
    decide();
}

void BayRelay::lost(std::uint8_t inputs) {
    for (std::size_t k = 0; k < 3; ++k) {
        if ((inputs & kQuantityOf[k]) != 0) {
            inputs_[k].has_last = false;
            inputs_[k].estimator.clear();
        }
    }
    follow_frequency();
    measure();
    decide();
}

void BayRelay::follow_frequency() {
    double const steady = frequency_.steady();
    if (steady != relative_) {
        relative_ = steady;
        for (Input& input : inputs_) {
            input.estimator.set_frequency(steady);
        }
        double const angle = 2 * std::numbers::pi * steady / params_.samples_per_cycle;
        turn_ = {elementary::cos(angle), elementary::sin(angle)};
        double const two = 4 * std::numbers::pi * (steady - 1);
        turn_two_cycles_ = {elementary::cos(two), elementary::sin(two)};
    }
}

/// Frequency and memory count samples: of each one, also of those that are bridged, they want a phasor.
void BayRelay::follow_voltage() {
    if (!inputs_[1].estimator.full()) {
        return;
    }
    follow_frequency();
    voltage_ = inputs_[1].estimator.phasors();
    voltage_sequence_ = sequence_of(voltage_);
    frequency_.push(voltage_sequence_.positive);
    memory_.push(voltage_sequence_.positive, turn_, turn_two_cycles_);
}

void BayRelay::measure() {
    measured_.available = 0;
    if (inputs_[0].estimator.full()) {
        measured_.i = inputs_[0].estimator.phasors();
        for (Complex& i : measured_.i) {
            i = params_.reversed ? -i : i;
        }
        measured_.i_sequence = sequence_of(measured_.i);
        measured_.available |= kCurrents;
    }
    measure_voltages();
    if (inputs_[2].estimator.full()) {
        measured_.bus_v = inputs_[2].estimator.phasors();
        measured_.available |= kBusVoltages;
    }
}

void BayRelay::measure_voltages() {
    if (!inputs_[1].estimator.full()) {
        frequency_.clear();
        memory_.clear();
        return;
    }
    measured_.v = voltage_;
    measured_.v_sequence = voltage_sequence_;
    measured_.polarising = memory_.voltage();
    measured_.frequency_hz = frequency_.hz();
    measured_.rocof_hz_per_s = frequency_.hz_per_s();
    unsigned const available = kVoltages | (frequency_.has_frequency() ? unsigned{kFrequency} : 0U) |
                               (frequency_.has_rate() ? unsigned{kRocof} : 0U) |
                               (memory_.has_voltage() ? unsigned{kPolarising} : 0U);
    measured_.available = static_cast<std::uint8_t>(measured_.available | available);
}

void BayRelay::decide() {
    functions_.step(measured_, trip_);
    bool any_blocked = false;
    for (std::size_t i = 0; i < before_.size(); ++i) {
        FunctionState const& now = functions_.states()[i];
        FunctionState const& before = before_[i];
        bool const blocked = functions_.is_blocked(i);
        any_blocked = any_blocked || blocked;
        if (blocked != blocked_before_[i]) {
            note(blocked ? FunctionEvent::Kind::block : FunctionEvent::Kind::unblock, i);
            blocked_before_[i] = blocked;
            ++changes_;
        }
        if (now == before) {
            continue;
        }
        bool const tells = functions_.functions()[i].of != NodeClass::rdir; // a direction comes and goes with the load
        if (tells && now.str && !before.str) {
            note(FunctionEvent::Kind::start, i, now.phases);
        }
        if (tells && now.op != before.op) {
            note(now.op ? FunctionEvent::Kind::operate : FunctionEvent::Kind::reset, i, now.phases);
        } else if (tells && !now.str && before.str) {
            note(FunctionEvent::Kind::reset, i);
        }
        changes_ += now.str != before.str || now.op != before.op ? 1 : 0;
        before_[i] = now;
    }
    if (pickup() != picked_up_) {
        picked_up_ = pickup();
        note(picked_up_ ? FunctionEvent::Kind::pickup : FunctionEvent::Kind::dropout);
        ++changes_;
    }
    bool const trip = functions_.operates() || (trip_ && params_.seal_in && !functions_.closes());
    if (trip != trip_) {
        trip_ = trip;
        note(trip ? FunctionEvent::Kind::trip : FunctionEvent::Kind::release);
        ++changes_;
    }
    changes_ += any_blocked != blocked_ ? 1 : 0;
    blocked_ = any_blocked;
}

bool BayRelay::reset() {
    if (functions_.operates()) {
        return false;
    }
    if (trip_) {
        trip_ = false;
        note(FunctionEvent::Kind::release);
        ++changes_;
    }
    return true;
}

void BayRelay::note(FunctionEvent::Kind kind, std::size_t function, std::uint8_t phases) {
    events_.push({index_, kind, function, phases, magnitudes(measured_.i), magnitudes(measured_.v)});
}

} // namespace gridspace::relay
