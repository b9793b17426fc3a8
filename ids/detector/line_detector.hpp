// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/detector/standing_difference.hpp"
#include "ids/detector/stream_guard.hpp"
#include "ids/detector/supervisor.hpp"

#include <cstdint>
#include <string>

namespace gridspace::ids {

/// Why the detector raises its alarm. A set of bits.
enum Alarm : std::uint32_t {
    kFlagged = 1U << 0U,     ///< paper, hold_off, monitor: a sample is off its forecast (held for 160 samples)
    kOneEnd = 1U << 1U,      ///< supervise: a change that only one end saw
    kUnconfirmed = 1U << 2U, ///< supervise: the relay picked up and the trip is withheld
    kNoise = 1U << 3U,       ///< the forecast error has grown so much that small forgeries would hide in it
    kNotArmed = 1U << 5U,    ///< supervise: the two ends have differed for 0.1 s, so no fault can be confirmed
    kMeasuringChain =
        1U << 6U,          ///< supervise: what the ends differ by all the time is beyond the accuracy classes, or moves
    kLockedOut = 1U << 4U, ///< paper: more than half of the last 0.1 s was replaced; the relay sees forecasts
};
using Alarms = std::uint32_t;
[[nodiscard]] std::string alarm_names(Alarms alarms); ///< "one_end, noise"

struct DetectorParams {
    GuardParams guard;
    SupervisorParams supervisor;
    StandingParams standing;
    bool along_the_line{true}; ///< both CTs count from the `from` end to the `to` end; false: both into the line
    bool guard_from{true}, guard_to{true}; ///< paper, hold_off: streams whose samples are replaced
};

/// One end of the line at one instant, for the detector.
struct EndInput {
    Abc i_a{};
    bool usable{false}; ///< received, and good enough for the relay
};

struct LineVerdict {
    std::int64_t index{0};
    bool granted{true};    ///< the relay may trip
    bool confirmed{false}; ///< supervise: both ends saw the onset
    Alarms alarms{0};
    bool alarm_rose{false};
    Abc from_accepted_a{}, to_accepted_a{}; ///< what the relay gets
    Abc difference_a{};                     ///< of the two ends, instantaneous
};

/// The detector of a line relay: a guard per stream, Kirchhoff's law between them, and the supervisor. No allocation
/// per sample.
class LineDetector {
  public:
    /// `model` must have passed check() and be made for the streams' rate.
    LineDetector(Model const& model, DetectorParams const& params);

    /// `picked_up`: whether the relay's element was above pickup at the sample before.
    LineVerdict const& step(std::int64_t index, EndInput const& from, EndInput const& to, bool picked_up);
    void restart();

    [[nodiscard]] LineVerdict const& verdict() const { return verdict_; }
    [[nodiscard]] StreamGuard const& from() const { return from_; }
    [[nodiscard]] StreamGuard const& to() const { return to_; }
    [[nodiscard]] Supervisor const& supervisor() const { return supervisor_; }
    [[nodiscard]] StandingDifference const& standing() const { return standing_; }
    [[nodiscard]] std::uint64_t alarms() const { return alarms_; } ///< times the alarm rose
    [[nodiscard]] DetectorParams const& params() const { return params_; }

  private:
    [[nodiscard]] Alarms present_alarms(bool picked_up);

    DetectorParams params_;
    StreamGuard from_, to_;
    Supervisor supervisor_;
    StandingDifference standing_;
    LineVerdict verdict_;
    std::int64_t last_flag_{INT64_MIN / 4};
    std::uint64_t alarms_{0};
    bool noisy_{false};
};

} // namespace gridspace::ids
