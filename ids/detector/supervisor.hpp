// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/detector/stream_guard.hpp"

#include <cstdint>
#include <limits>

namespace gridspace::ids {

/// All lengths are in samples at 4800 Hz.
struct SupervisorParams {
    enum class OnUnconfirmed {
        delay, ///< trip anyway when the pickup has lasted `delay_samples`: no fault is left to the backup protection
        block, ///< never: no forgery of one stream trips, and the 2 to 3 % of faults that only one end sees are left
    };
    OnUnconfirmed on_unconfirmed{OnUnconfirmed::delay};
    int delay_samples{96};
    double kirchhoff_percent{3}; ///< of max(nominal, running peak): the two ends differ
    int burst_window{4}, burst_count{2};
    int weak_end_count{1};      ///< flags that are enough at the second end; with a fixed threshold use burst_count
    int both_ends_within{6};    ///< a real change is seen at both ends at once
    int kirchhoff_clean{40};    ///< samples without a difference that make the next one "first"
    int armed_within{480};      ///< so many samples without `kirchhoff_clean` of them in a row: it is not armed
    int synchronous_within{12}; ///< between the onset and the first difference
    int hold_samples{160};      ///< how long a permission lasts
    double noise_alarm_percent{0.92}; ///< standard deviation of the forecast error; 0.5 % of noise makes 0.65 to 0.9 %
};

/// Decides whether a pickup of the differential relay is a fault or a forgery: a fault changes the currents of both
/// ends at one instant, and that is the instant at which they begin to differ. A forged stream changes alone.
///
/// burst: flags of the last `burst_window` samples, any phase of one end, add up to `burst_count`; a sample beyond
/// twice its limit counts two, because a good forecaster is surprised by a kink of the current only once. onset: bursts
/// at both ends within `both_ends_within`. first difference: `burst_count` of `burst_window` samples violate
/// Kirchhoff's law after `kirchhoff_clean` clean ones. permission: onset and first difference within
/// `synchronous_within` of each other; it lasts `hold_samples`.
///
/// What it cannot tell from a fault: a coordinated forgery of both ends, and a forgery that starts within
/// `synchronous_within` of a real disturbance.
class Supervisor {
  public:
    explicit Supervisor(SupervisorParams const& params) : params_{params} {}

    struct Input {
        bool usable{false};             ///< both ends were received and had a forecast
        int from_flags{0}, to_flags{0}; ///< 0: no phase flagged, 1: flagged, 2: beyond twice the limit
        bool differs{false};            ///< any phase: |sum into the line| above the Kirchhoff limit
        bool same_phase_alone{false};   ///< a phase is flagged at one end only, and the ends differ in that phase
    };
    /// `picked_up`: what the relay's element said at the sample before.
    void step(std::int64_t index, Input const& in, bool picked_up);
    void restart();

    [[nodiscard]] bool confirmed() const { return now_ <= permitted_until_; } ///< evidence from both ends
    [[nodiscard]] bool timed_out() const { return timed_out_; }               ///< `delay` has run out
    [[nodiscard]] bool granted() const { return confirmed() || timed_out_; }
    [[nodiscard]] bool suspicious() const {
        return suspicious_;
    } ///< a change that only one end saw; until 160 quiet samples
    [[nodiscard]] bool differing() const { return differing_; }
    /// False: the ends differ all the time (a measuring chain with a standing error, or somebody who makes one), so no
    /// difference is a first one and no fault can be confirmed.
    [[nodiscard]] bool armed() const { return unarmed_ < params_.armed_within; }
    [[nodiscard]] std::uint64_t alarms() const { return alarms_; }

  private:
    static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 4;
    void look_for_forgery(Input const& in);

    SupervisorParams params_;
    std::uint32_t from_bits_{0}, to_bits_{0}, differ_bits_{0}; ///< two bits per sample
    std::int64_t now_{0}, from_burst_{kNever}, to_burst_{kNever}, from_flag_{kNever}, to_flag_{kNever}, onset_{kNever},
        first_difference_{kNever}, last_difference_{kNever};
    std::int64_t permitted_until_{kNever}, doubt_since_{kNever}, last_doubt_{kNever};
    int clean_{0}, pickup_run_{0};
    int unarmed_{0}; ///< usable samples since the last at which the next difference would have been a first one
    bool differing_{false}, suspicious_{false}, timed_out_{false};
    std::uint64_t alarms_{0};
};

} // namespace gridspace::ids
