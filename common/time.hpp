// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/rational.hpp"

#include <chrono>
#include <compare>
#include <cstdint>
#include <string>

namespace gridspace {

/// A length of simulated time: a count of the run's time quanta (TimeBase).
struct SimSpan {
    std::int64_t quanta{0};
    friend auto operator<=>(SimSpan, SimSpan) = default;
    friend constexpr SimSpan operator+(SimSpan a, SimSpan b) { return {a.quanta + b.quanta}; }
    friend constexpr SimSpan operator-(SimSpan a, SimSpan b) { return {a.quanta - b.quanta}; }
    friend constexpr SimSpan operator*(SimSpan a, std::int64_t n) { return {a.quanta * n}; }
};

/// An instant of simulated time: quanta since simulated time 0 (the scenario's epoch). Never mixes with wall time.
struct SimTime {
    std::int64_t quanta{0};
    friend auto operator<=>(SimTime, SimTime) = default;
    friend constexpr SimTime operator+(SimTime t, SimSpan d) { return {t.quanta + d.quanta}; }
    friend constexpr SimTime operator-(SimTime t, SimSpan d) { return {t.quanta - d.quanta}; }
    friend constexpr SimSpan operator-(SimTime a, SimTime b) { return {a.quanta - b.quanta}; }
};

/// An instant of the monotonic clock.
using WallTime = std::chrono::steady_clock::time_point;

/// What a quantum of simulated time is, in a run: an exact fraction of a second of which every step and tick is a whole
/// multiple. Simulated time is counted, never accumulated in floating point or in nanoseconds (docs/design/time.md).
class TimeBase {
  public:
    TimeBase() = default;
    explicit TimeBase(Rational quantum_s) : quantum_s_{quantum_s} {}

    [[nodiscard]] Rational quantum_s() const { return quantum_s_; }

    /// Seconds, exactly / as the nearest double.
    [[nodiscard]] Rational seconds_exact(SimTime t) const { return quantum_s_ * Rational{t.quanta}; }
    [[nodiscard]] double seconds(SimTime t) const { return seconds(SimSpan{t.quanta}); }
    [[nodiscard]] double seconds(SimSpan d) const {
        return static_cast<double>(d.quanta) * static_cast<double>(quantum_s_.num()) /
               static_cast<double>(quantum_s_.den());
    }

    /// Nanoseconds since simulated time 0, rounded to nearest. The inverse is exact while a quantum is longer than 1
    /// ns: from_nanoseconds(nanoseconds(t)) == t, so a stamp on the wire loses nothing.
    [[nodiscard]] std::int64_t nanoseconds(SimTime t) const;
    [[nodiscard]] SimTime from_nanoseconds(std::int64_t ns) const;

    /// The span of so many seconds, rounded up to whole quanta (latencies), or to the nearest quantum (instants).
    [[nodiscard]] SimSpan ceil(Rational seconds) const;
    [[nodiscard]] SimSpan nearest(Rational seconds) const;

    /// So many seconds (not negative) after `t`, in whole nanoseconds; as late as can be when that is out of reach.
    [[nodiscard]] SimTime later(SimTime t, double seconds) const;

    friend bool operator==(TimeBase, TimeBase) = default;

  private:
    Rational quantum_s_{1};
};

/// "5.500 s", "1 h 03 min", for people.
[[nodiscard]] std::string human_duration(double seconds);

/// "10s", "5min", "2h", "250ms", or seconds as a number or fraction; nothing when it is not such a text or not
/// positive.
[[nodiscard]] std::optional<Rational> parse_duration(std::string_view text);

/// "2019-12-01T09:00:00Z" to seconds since 1970 and back; nothing when it is not such a text.
[[nodiscard]] std::optional<std::int64_t> parse_utc(std::string_view text);
[[nodiscard]] std::string format_utc(std::int64_t unix_seconds);

} // namespace gridspace
