// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/ptp/management_message.hpp"

#include <string>

namespace gridspace::ptp {

/// What smpSynch of sampled values says about a clock (IEC 61850-9-2, 61869-9), by what a PTP daemon says of it. Pure;
/// times are nanoseconds on any one axis that does not jump.
class TimeQuality {
  public:
    struct Params {
        std::int64_t within_ns{50'000};                ///< of its grandmaster; further away is not synchronised
        std::int64_t holdover_ns{5'000'000'000};       ///< for so long its own oscillator is good enough
        std::int64_t answers_within_ns{1'500'000'000}; ///< a daemon that is silent for longer is not there
    };
    /// Of Sync messages, which come once a second or more often: without any, an offset is an old one.
    static constexpr std::int64_t kMeasuresWithinNs = 4'000'000'000;
    /// Who has not been synchronised for so long since the first look is reported.
    static constexpr std::int64_t kPatienceNs = 5'000'000'000;
    enum class State : std::uint8_t { never, following, holdover, lost };

    explicit TimeQuality(Params const& params) : params_{params} {}

    void hear(ManagementResponse const& response, std::int64_t now_ns);
    /// Whatever was heard or not; true when there is something to report: state or smpSynch are others than at the last
    /// look, or it has not been synchronised within the patience.
    bool look(std::int64_t now_ns);

    [[nodiscard]] State state() const { return state_; }
    /// 2: a clock that is traceable to UTC; 1: a local one; 0: none, or longer ago than the holdover.
    [[nodiscard]] std::uint8_t smp_synch() const { return smp_synch_; }
    [[nodiscard]] std::int64_t offset_ns() const { return status_ ? status_->master_offset_ns : 0; }
    /// Why it is as it is, for the events of a run.
    [[nodiscard]] std::string text() const;

  private:
    /// What the daemon's last words amount to: 0, 1 or 2.
    [[nodiscard]] std::uint8_t heard_synch(std::int64_t now_ns) const;

    Params params_;
    ClockIdentity own_{};
    std::optional<TimeStatus> status_;
    std::optional<ParentDataSet> parent_;
    std::int64_t status_ns_{0}, parent_ns_{0}; ///< when they were heard
    std::int64_t measured_ns_{0};              ///< when the offset was measured last
    std::int64_t good_ns_{0};                  ///< when it was synchronised last
    std::optional<std::int64_t> began_ns_;     ///< the first look
    bool answers_{false};
    bool told_{false}; ///< that there is no clock yet
    State state_{State::never};
    std::uint8_t smp_synch_{0};
};

} // namespace gridspace::ptp
