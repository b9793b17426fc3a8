// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/port/wire_clock.hpp"

#include <cmath>
#include <optional>

namespace gridspace::relay {

/// When the samples of a stream were taken. A frame's counter says which sample of a second it is; the simulation clock
/// says which second.
class SampleTime {
  public:
    SampleTime(bus::Node const& node, double rate_hz, double speed)
        : node_{node}, clock_{node}, rate_hz_{rate_hz}, speed_{speed} {}

    /// Real time: the simulated time at which a frame came that is looked at `now_ns`. Of one that has waited, because
    /// this process stood still, the simulation clock no longer says it: it came so long after the last one that had
    /// not.
    void came(std::int64_t arrived_ns, std::int64_t now_ns) {
        constexpr std::int64_t kAtOnceNs = 100'000'000;
        bool const at_once = came_ns_ == 0 || now_ns - arrived_ns < kAtOnceNs;
        came_s_ = at_once ? now_s() : came_s_ + static_cast<double>(arrived_ns - came_ns_) * 1e-9 * speed_;
        came_ns_ = arrived_ns;
    }
    /// Real time: true once, when simulated time has become known. A relay that is there before the run, or comes back
    /// in it, has none at first: it protects by frames alone, and what it publishes needs simulated times.
    [[nodiscard]] bool becomes_known() {
        if (is_known() || !node_.clock_runs()) {
            return false;
        }
        known_since_ns_ = clock_.now();
        came_ns_ = 0; // what came before was put at no time
        return true;
    }
    [[nodiscard]] bool is_known() const { return clock_.simulated() || known_since_ns_; }
    /// Real time: which second a counter belongs to was known when the newest frame came.
    [[nodiscard]] bool was_known_on_arrival() const { return known_since_ns_ && came_ns_ >= *known_since_ns_; }

    /// Simulated time of a sample, s.
    [[nodiscard]] double instant_s(std::int64_t index) const {
        double const in_second_s = static_cast<double>(index) / rate_hz_;
        double const reference_s = came_ns_ == 0 ? now_s() : came_s_;
        return std::round(reference_s - in_second_s) + in_second_s;
    }
    /// The same as UTC: on the epoch, or in real time on the run's start.
    [[nodiscard]] std::int64_t utc_ns(std::int64_t index) const {
        std::int64_t const ns = std::llround(instant_s(index) * 1e9);
        return clock_.simulated() ? clock_.utc_ns(ns) : node_.start_unix_ns() + ns;
    }
    /// From the instant of a sample to `unix_ns`, ms. Real time.
    [[nodiscard]] double age_ms(std::int64_t index, std::int64_t unix_ns) const {
        return clock_.age_ms(unix_ns, instant_s(index), speed_);
    }

  private:
    [[nodiscard]] double now_s() const { return node_.time_base().seconds(node_.latest_time()); }

    bus::Node const& node_;
    gateways::WireClock clock_;
    double rate_hz_, speed_;
    std::int64_t came_ns_{0}; ///< when the newest frame came, and at which simulated time
    double came_s_{0};
    std::optional<std::int64_t> known_since_ns_;
};

} // namespace gridspace::relay
