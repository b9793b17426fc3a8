// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "gateways/port/arrival_clock.hpp"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <limits>
#include <optional>

namespace gridspace::gateways {

/// The time that the state machines of a daemon live in: nanoseconds of simulated time in lockstep, of the monotonic
/// clock in real time. What they stamp with is UTC: the scenario's epoch and simulated time, or the clock of the
/// machine.
class WireClock {
  public:
    explicit WireClock(bus::Node const& node) : node_{node} {}

    [[nodiscard]] std::int64_t of(SimTime t) const { return node_.time_base().nanoseconds(t); } ///< lockstep
    [[nodiscard]] std::int64_t now() const {                                                    ///< real time
        return std::chrono::steady_clock::now().time_since_epoch().count();
    }
    [[nodiscard]] std::int64_t utc_ns(std::int64_t now_ns) const {
        if (node_.lockstep()) {
            return node_.config().clock.epoch_unix_s * 1'000'000'000 + now_ns;
        }
        timespec t{};
        clock_gettime(CLOCK_REALTIME, &t);
        return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
    }
    /// UTC of simulated time 0; in real time 0 before it is known.
    [[nodiscard]] std::int64_t start_utc_ns() const { return simulated() ? utc_ns(0) : node_.start_unix_ns(); }
    /// Real time: the same, and nothing before it is known. Without a simulator it always is: UTC counts from 1970.
    [[nodiscard]] std::optional<std::int64_t> known_start_unix_ns() const {
        std::int64_t const start = node_.start_unix_ns();
        return start != 0 || node_.config().clock.simulator.empty() ? std::optional{start} : std::nullopt;
    }
    /// Nanoseconds of simulated time at `tick`; in real time now, at that speed, and -1 before it is known.
    [[nodiscard]] std::int64_t simulated_ns(SimTime tick, double speed) const {
        if (simulated()) {
            return of(tick);
        }
        std::int64_t const start = node_.start_unix_ns();
        return start == 0 ? -1 : static_cast<std::int64_t>(static_cast<double>(utc_ns(0) - start) * speed);
    }
    /// The same when a frame came: its own time; in real time that of the look that found it.
    [[nodiscard]] std::int64_t heard_ns(SimTime frame, std::int64_t look_ns) const {
        return simulated() ? of(frame) : look_ns;
    }
    /// UTC when the clock of the state machines showed `ns`, by what both show now.
    [[nodiscard]] std::int64_t utc_at(std::int64_t ns) const {
        if (node_.lockstep()) {
            return utc_ns(ns);
        }
        ArrivalClock::Reading const now = ArrivalClock::read();
        return now.utc_ns - (now.steady_ns - ns);
    }
    /// The first instant of simulated time that is not before `ns`.
    [[nodiscard]] SimTime at_or_after(std::int64_t ns) const {
        SimTime const t = node_.time_base().from_nanoseconds(ns);
        return of(t) < ns ? SimTime{t.quanta + 1} : t;
    }
    /// Whether the state machines live in simulated time.
    [[nodiscard]] bool simulated() const { return node_.lockstep(); }
    /// What the clock shows in a tick: its end, or now.
    [[nodiscard]] std::int64_t at_tick(SimTime tick) const { return simulated() ? of(tick) : now(); }
    /// The first instant of the grid of simulated time that is not before `ns`; in real time `ns` itself.
    [[nodiscard]] std::int64_t on_grid(std::int64_t ns) const { return simulated() ? of(at_or_after(ns)) : ns; }
    /// The simulated time that belongs to `ns`; in real time the newest that is known.
    [[nodiscard]] SimTime sim_time(std::int64_t ns) const {
        return simulated() ? at_or_after(ns) : node_.latest_time();
    }
    /// What the clock shows when simulated time is `s`; in real time nothing before it is known when the run began.
    [[nodiscard]] std::optional<std::int64_t> when(Rational const& s, double speed) const {
        if (simulated()) {
            return of(SimTime{} + node_.time_base().nearest(s));
        }
        if (node_.start_unix_ns() == 0) {
            return std::nullopt;
        }
        return now() - std::llround(age_ms(utc_ns(0), s.to_double(), speed) * 1e6);
    }
    /// How long a span of simulated time takes on this clock, at that speed.
    [[nodiscard]] std::int64_t lasting(SimSpan span, double speed) const {
        std::int64_t const ns = of(SimTime{} + span);
        return simulated() ? ns : std::llround(static_cast<double>(ns) / speed);
    }
    /// Milliseconds since simulated time 0, on the clock that frames live in.
    [[nodiscard]] double since_start_ms(std::int64_t ns) const {
        return simulated() ? static_cast<double>(ns) / 1e6 : age_ms(utc_ns(0), 0, 1);
    }
    /// Milliseconds from the instant at which simulated time was `time_s` (at this speed) to `unix_ns`. Real time; nan
    /// before it is known when the run began.
    [[nodiscard]] double age_ms(std::int64_t unix_ns, double time_s, double speed) const {
        auto const start_ns = known_start_unix_ns();
        return start_ns ? static_cast<double>(unix_ns - *start_ns) / 1e6 - time_s * 1e3 / speed
                        : std::numeric_limits<double>::quiet_NaN();
    }
    [[nodiscard]] static std::chrono::steady_clock::time_point wall(std::int64_t ns) {
        return std::chrono::steady_clock::time_point{std::chrono::nanoseconds{ns}};
    }

  private:
    bus::Node const& node_;
};

} // namespace gridspace::gateways
