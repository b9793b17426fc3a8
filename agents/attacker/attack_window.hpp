// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace gridspace::attacker {

/// When an attack acts. Samples or nanoseconds, whatever its owner counts in.
struct AttackTimes {
    std::int64_t from{0}, until{0}; ///< `until` is not included
    std::int64_t every{0};          ///< from one window to the next
    std::int64_t times{1};          ///< how many windows
    std::int64_t ramp{0};           ///< so long from nothing to its full strength
    bool waits{false};              ///< it begins within a window when trigger() is called, not at its start

    friend bool operator==(AttackTimes const&, AttackTimes const&) = default;
};

/// The windows of an attack. Times are asked for in order.
class AttackWindow {
  public:
    explicit AttackWindow(AttackTimes const& times) : times_{times} {}

    /// Since when it acts at `now`; nothing when it does not.
    [[nodiscard]] std::optional<std::int64_t> start(std::int64_t now) const {
        auto const begin = window(now);
        if (!begin || !times_.waits) {
            return begin;
        }
        return triggered_ && *triggered_ >= *begin && *triggered_ <= now ? triggered_ : std::nullopt;
    }
    [[nodiscard]] bool acts(std::int64_t now) const { return start(now).has_value(); }
    /// What it waits for has come. Only the first time within a window counts, and none outside.
    bool trigger(std::int64_t now) {
        if (!times_.waits || !window(now) || acts(now)) {
            return false;
        }
        triggered_ = now;
        return true;
    }
    /// The first instant at or after `now` at which it acts, as far as that is known.
    [[nodiscard]] std::optional<std::int64_t> next(std::int64_t now) const {
        if (acts(now)) {
            return now;
        }
        if (times_.waits) {
            return std::nullopt;
        }
        if (now <= times_.from) {
            return times_.from;
        }
        std::int64_t const k = times_.every <= 0 ? times_.times : (now - times_.from + times_.every - 1) / times_.every;
        return k < times_.times ? std::optional{times_.from + k * times_.every} : std::nullopt;
    }
    /// 0 to 1.
    [[nodiscard]] double strength(std::int64_t start, std::int64_t now) const {
        return times_.ramp <= 0 ? 1
                                : std::min(static_cast<double>(now - start) / static_cast<double>(times_.ramp), 1.0);
    }
    [[nodiscard]] AttackTimes const& times() const { return times_; }

  private:
    /// The beginning of the window that `now` is in.
    [[nodiscard]] std::optional<std::int64_t> window(std::int64_t now) const {
        if (now < times_.from) {
            return std::nullopt;
        }
        std::int64_t const k =
            times_.times <= 1 || times_.every <= 0 ? 0 : std::min((now - times_.from) / times_.every, times_.times - 1);
        std::int64_t const begin = times_.from + k * times_.every;
        return now < begin + (times_.until - times_.from) ? std::optional{begin} : std::nullopt;
    }

    AttackTimes times_;
    std::optional<std::int64_t> triggered_;
};

} // namespace gridspace::attacker
