// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

#include <optional>
#include <vector>

namespace gridspace::relay {

struct RrecParams {
    double rate_hz{4800};
    std::vector<std::size_t> initiated_by;   ///< functions whose trip is followed by a reclosing; none: every trip
    std::vector<double> dead_times_s{0.5};   ///< of each shot
    std::optional<std::size_t> synchrocheck; ///< function that has to release
    double wait_release_s{5};                ///< for it, then lockout
    double open_below_a{0};                  ///< the breaker is open when no pole carries more
    double wait_open_s{0.5};                 ///< after a trip, then lockout
    double pulse_s{0.1};                     ///< of the closing command
    double reclaim_s{10};                    ///< without a trip after it: everything begins anew
};

/// Automatic reclosing (79, RREC; IEC 61850-7-4, AutoRecSt): trip, breaker open, dead time, release, closing, reclaim
/// time; a trip in the reclaim time is the next shot, after the last one lockout. Lockout ends by unlock(). `op` is the
/// closing command; the relay's trip is released with it.
class Rrec final : public Function {
  public:
    enum class State : std::uint8_t { ready, wait_open, dead_time, wait_release, closing, reclaim, lockout };

    explicit Rrec(RrecParams params) : params_{std::move(params)} {}
    [[nodiscard]] std::uint8_t needs() const override { return kCurrents; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override;
    void unlock() { enter(State::ready); }
    [[nodiscard]] State state() const { return state_; }

  private:
    void enter(State state);
    [[nodiscard]] bool has_lasted(double seconds) const { return since_ >= samples_of(seconds, params_.rate_hz); }
    void go_on(FunctionInput const& input, bool tripped);

    RrecParams params_;
    State state_{State::ready};
    std::int64_t since_{0};
    std::size_t shot_{0};
    bool tripped_{false};
};

} // namespace gridspace::relay
