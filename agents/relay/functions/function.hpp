// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/phasor.hpp"

#include <cstdint>
#include <span>
#include <string_view>

namespace gridspace::relay {

/// What a relay measures at one instant, in primary quantities. Currents are counted into what is protected.
struct Measurement {
    Phasors i{}, v{}, bus_v{}; ///< A, V to earth; the bus voltages are those beyond an open breaker
    Sequence i_sequence{}, v_sequence{};
    /// Positive-sequence voltage of two cycles ago, turned on to now; held where the voltage has collapsed.
    Complex polarising{};
    double frequency_hz{50}, rocof_hz_per_s{0};
    std::uint8_t available{0}; ///< of Quantity
};

/// What a function needs to decide.
enum Quantity : std::uint8_t {
    kCurrents = 1U << 0U,
    kVoltages = 1U << 1U,
    kBusVoltages = 1U << 2U,
    kFrequency = 1U << 3U,
    kRocof = 1U << 4U,
    kPolarising = 1U << 5U,
};

/// What a function says, with the names of IEC 61850-7-4.
struct FunctionState {
    bool str{false};                     ///< started
    bool op{false};                      ///< operates; of RSYN: releases
    std::uint8_t phases{0};              ///< started: bit 0: a, 1: b, 2: c
    std::uint8_t forward{0}, reverse{0}; ///< RDIR: direction of each phase
    friend bool operator==(FunctionState const&, FunctionState const&) = default;
};

struct FunctionInput {
    Measurement const& measured;
    std::span<FunctionState const> others; ///< states of all functions; those that come first are of this instant
    bool trip{false};                      ///< of the relay, as it was at the last instant
};

/// A quantity that a function measures and may publish: the end of its signal's name, and its unit.
struct MeasuredQuantity {
    std::string_view name, unit;
};

/// A protection or protection-related function: one logical node. Takes a measurement per sample; allocates nothing.
class Function {
  public:
    virtual ~Function() = default;
    /// Of Quantity. While something of it is not available the function is reset.
    [[nodiscard]] virtual std::uint8_t needs() const = 0;
    virtual FunctionState step(FunctionInput const& input) = 0;
    virtual void reset() = 0;

    /// What it measures, where that can be published.
    [[nodiscard]] virtual std::span<MeasuredQuantity const> quantities() const { return {}; }
    /// Their values now, in that order; NaN: there is none, or it does not count. Only while what it needs is
    /// available.
    virtual void measure(Measurement const& /*measured*/, std::span<double> /*out*/) const {}
};

/// Samples of a time, to the nearest.
[[nodiscard]] inline std::int64_t samples_of(double seconds, double rate_hz) {
    return std::llround(seconds * rate_hz);
}

/// Counts samples without a gap: true from the sample on that lies `delay` samples behind the first.
class DefiniteTimer {
  public:
    explicit DefiniteTimer(std::int64_t delay = 0) : delay_{delay} {}
    bool step(bool on) {
        if (!on) {
            count_ = 0;
            return false;
        }
        if (count_ >= delay_) {
            return true;
        }
        ++count_;
        return false;
    }
    void reset() { count_ = 0; }

  private:
    std::int64_t delay_, count_{0};
};

} // namespace gridspace::relay
