// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace gridspace::bus {

/// Notices that a machine's clock is set while a run in real time measures with it, or that it is another than the
/// simulator's. All times in nanoseconds. In lockstep no machine's clock counts.
class ClockWatch {
  public:
    static constexpr std::int64_t kTolerableStep = 100'000'000; ///< what chrony corrects by running faster or slower
    static constexpr std::int64_t kTolerableOffset = 200'000'000;
    static constexpr std::int64_t kTolerableLateness = 10'000'000'000; ///< of what comes from this very machine
    static constexpr int kSamples = 20; ///< a late sample looks like an offset; not all of so many are late,
    static constexpr std::int64_t kSpan = 3'000'000'000; ///< and not for so long: who gets no processor is late for all

    static constexpr std::int64_t kLongestLook = 10'000'000; ///< who was not scheduled in between has seen no step

    /// By how much the wall clock has been set since the first look, if it was. A look reads the steady clock, the wall
    /// clock, and the steady clock again.
    std::optional<std::int64_t> step(std::int64_t steady_before_ns, std::int64_t wall_ns,
                                     std::int64_t steady_after_ns) {
        if (steady_after_ns - steady_before_ns > kLongestLook) {
            return std::nullopt;
        }
        std::int64_t const difference = wall_ns - steady_before_ns;
        if (!difference_) {
            difference_ = difference;
        }
        std::int64_t const by = difference - *difference_;
        return std::llabs(by) > kTolerableStep ? std::optional{by} : std::nullopt;
    }

    /// Who has the sender's own clock and seems to be ahead of it is only late: the machine is busy.
    static bool is_lateness(std::int64_t ahead_ns) { return ahead_ns > 0 && ahead_ns < kTolerableLateness; }

    /// How far this machine's clock is ahead of a sender's, when enough of its samples have said so. To be called when
    /// each sample was sent and when it came.
    std::optional<std::int64_t> offset(std::int64_t sent_ns, std::int64_t arrived_ns) {
        // What was kept for a late joiner, or held up, comes in a burst: quicker than it was sent.
        bool const in_time = sent_ != 0 && 2 * (arrived_ns - arrived_) >= sent_ns - sent_;
        sent_ = sent_ns;
        arrived_ = arrived_ns;
        if (!in_time || judged_) {
            return std::nullopt;
        }
        std::int64_t const ahead = arrived_ns - sent_ns;
        began_ = samples_ == 0 ? arrived_ns : began_;
        least_ = samples_ == 0 || std::llabs(ahead) < std::llabs(least_) ? ahead : least_;
        judged_ = ++samples_ >= kSamples && arrived_ns - began_ >= kSpan;
        return judged_ && std::llabs(least_) > kTolerableOffset ? std::optional{least_} : std::nullopt;
    }

  private:
    std::optional<std::int64_t> difference_;
    std::int64_t least_{0}, sent_{0}, arrived_{0}, began_{0};
    int samples_{0};
    bool judged_{false};
};

} // namespace gridspace::bus
