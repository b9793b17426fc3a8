// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace gridspace {

/// Holds simulated time to the wall clock: absolute deadlines on the monotonic clock, never relative sleeps, so that
/// lateness does not add up. Speed 0: no pace.
class Pacer {
  public:
    explicit Pacer(double speed) : speed_{speed} {}

    /// Simulated time 0 is now.
    void start();
    /// Simulated time 0 is the next whole second of UTC by this machine's clock, which is waited for. That second, in
    /// nanoseconds since 1970.
    std::int64_t start_on_utc_second(std::atomic<bool> const& stop);
    /// After a pause of this length, everything is due so much later.
    void skip(std::chrono::steady_clock::duration pause) { start_ += pause; }
    /// Waits until simulated time `time_s` is due. False when it was due already (an overrun), by `late()`.
    bool wait(double time_s, std::atomic<bool> const& stop);
    [[nodiscard]] std::chrono::nanoseconds late() const { return late_; }
    [[nodiscard]] std::uint64_t overruns() const { return overruns_; }
    [[nodiscard]] std::chrono::nanoseconds worst() const { return worst_; }
    [[nodiscard]] bool paced() const { return speed_ > 0; }

  private:
    static void sleep_until(std::chrono::steady_clock::time_point due, std::atomic<bool> const& stop);
    double speed_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::nanoseconds late_{0}, worst_{0};
    std::uint64_t overruns_{0};
};

} // namespace gridspace
