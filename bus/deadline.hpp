// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>

namespace gridspace::bus {

/// The end of a wait; 0 seconds means that there is none (a debugger is attached, a run is paused).
class Deadline {
  public:
    using Clock = std::chrono::steady_clock;
    explicit Deadline(double seconds) {
        if (seconds > 0) {
            at_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{seconds});
        }
    }
    [[nodiscard]] bool passed() const { return at_ && Clock::now() >= *at_; }
    [[nodiscard]] std::chrono::milliseconds left() const {
        using std::chrono::milliseconds;
        return at_ ? std::max(milliseconds{0}, std::chrono::duration_cast<milliseconds>(*at_ - Clock::now()))
                   : milliseconds{3'600'000};
    }
    /// Waits for `ready`; false when the deadline passed first.
    template <class Ready>
    [[nodiscard]] bool wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock,
                            Ready const& ready) const {
        if (!at_) {
            changed.wait(lock, ready);
            return true;
        }
        return changed.wait_until(lock, *at_, ready);
    }

  private:
    std::optional<Clock::time_point> at_;
};

} // namespace gridspace::bus
