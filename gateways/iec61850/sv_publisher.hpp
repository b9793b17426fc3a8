// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/rational.hpp"
#include "gateways/iec61850/sv_template.hpp"

namespace gridspace::iec61850 {

/// The instants of a sampled stream, exact: sample n is at n * den / num seconds after the start, never a sum of
/// rounded periods.
class SampleGrid {
  public:
    explicit SampleGrid(Rational rate_hz) : rate_hz_{rate_hz} {}
    /// Rounded to nearest nanosecond.
    [[nodiscard]] std::int64_t nanoseconds(std::int64_t sample) const noexcept {
        __extension__ using Wide = __int128;
        Wide const numerator = Wide{sample} * rate_hz_.den() * 1'000'000'000;
        Wide const den = rate_hz_.num();
        Wide const doubled = 2 * numerator + den;
        Wide const quotient = doubled / (2 * den);
        return static_cast<std::int64_t>(doubled < 0 && quotient * 2 * den != doubled ? quotient - 1 : quotient);
    }
    [[nodiscard]] Rational rate_hz() const noexcept { return rate_hz_; }

  private:
    Rational rate_hz_;
};

/// Publisher of one SV stream: fills the ASDUs of a frame with consecutive samples and gives the frame out with the
/// last of them, which is when a merging unit sends it. smpCnt is the sample's index modulo `wrap`, so sample 0 is on
/// the second. A frame that lacks a sample is never sent: its other ASDUs would be older ones.
class SvPublisher {
  public:
    /// `wrap`: samples after which smpCnt is 0 again (the rate, when a second holds a whole number of them). All ASDUs
    /// of `frame` belong to this stream.
    SvPublisher(SvTemplate frame, std::uint32_t wrap)
        : frame_{std::move(frame)}, wrap_{wrap}, all_{(std::uint64_t{1} << frame_.asdus()) - 1} {}

    /// Where the data set of sample `index` >= 0 is written; commit() must follow. A frame begins at a multiple of
    /// samples_per_frame().
    [[nodiscard]] std::span<std::uint8_t> sample(std::int64_t index) noexcept {
        auto const slot = static_cast<std::size_t>(index % static_cast<std::int64_t>(frame_.asdus()));
        std::int64_t const first = index - static_cast<std::int64_t>(slot);
        if (first != first_) {
            // A publisher that begins in the middle of a frame has left nothing out.
            incomplete_ += filled_ != 0 && filled_ != all_ && begun_ ? 1 : 0;
            begun_ = begun_ || first_ >= 0;
            first_ = first;
            filled_ = 0;
        }
        fresh_ = (filled_ >> slot & 1U) == 0;
        filled_ |= std::uint64_t{1} << slot;
        frame_.set_smp_cnt(slot, static_cast<std::uint16_t>(index % wrap_));
        return frame_.sample(slot);
    }
    /// The frame, when the sample completed it; otherwise nothing: also when it was sent already. Valid until the next
    /// call.
    [[nodiscard]] Octets commit() noexcept {
        if (filled_ != all_ || !fresh_) {
            return {};
        }
        ++sent_;
        return frame_.frame();
    }
    void set_synch(std::uint8_t synch) noexcept {
        for (std::size_t i = 0; i < frame_.asdus(); ++i) {
            frame_.set_smp_synch(i, synch);
        }
    }
    [[nodiscard]] std::size_t samples_per_frame() const noexcept { return frame_.asdus(); }
    [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
    /// Frames that were begun and not sent, because a sample of them did not come.
    [[nodiscard]] std::uint64_t incomplete() const noexcept { return incomplete_; }
    [[nodiscard]] SvTemplate& frame() noexcept { return frame_; }

  private:
    SvTemplate frame_;
    std::int64_t wrap_;
    std::uint64_t all_;       ///< a bit per ASDU
    std::uint64_t filled_{0}; ///< those that hold a sample of this frame
    std::int64_t first_{-1};  ///< index of this frame's first sample
    bool fresh_{false};       ///< the sample has not been in this frame before
    bool begun_{false};       ///< this is not the first frame
    std::uint64_t sent_{0}, incomplete_{0};
};

/// When a publisher wakes and what it then owes: absolute deadlines, every sample sent exactly once however late.
class SendSchedule {
  public:
    /// Frame k is due at start_ns + (k + 1) * samples_per_frame - 1 periods.
    SendSchedule(Rational rate_hz, std::size_t samples_per_frame, std::int64_t start_ns, std::int64_t first_frame = 0)
        : grid_{rate_hz}, per_frame_{static_cast<std::int64_t>(samples_per_frame)}, start_ns_{start_ns},
          next_{first_frame} {}

    [[nodiscard]] std::int64_t due_ns() const noexcept { return due_ns(next_); }
    [[nodiscard]] std::int64_t next_frame() const noexcept { return next_; }
    /// How many frames are owed now, at most `limit` (a long stall is caught up over several wake-ups). Counts a
    /// wake-up that found more than one as late.
    [[nodiscard]] std::size_t owed(std::int64_t now_ns, std::size_t limit) noexcept {
        std::size_t count = 0;
        while (count < limit && due_ns(next_ + static_cast<std::int64_t>(count)) <= now_ns) {
            ++count;
        }
        if (count > 1) {
            ++late_wakeups_;
            worst_late_ns_ = std::max(worst_late_ns_, now_ns - due_ns());
        }
        return count;
    }
    void sent(std::size_t frames) noexcept { next_ += static_cast<std::int64_t>(frames); }
    [[nodiscard]] std::uint64_t late_wakeups() const noexcept { return late_wakeups_; }
    [[nodiscard]] std::int64_t worst_late_ns() const noexcept { return worst_late_ns_; }

  private:
    [[nodiscard]] std::int64_t due_ns(std::int64_t frame) const noexcept {
        return start_ns_ + grid_.nanoseconds((frame + 1) * per_frame_ - 1);
    }
    SampleGrid grid_;
    std::int64_t per_frame_, start_ns_, next_;
    std::uint64_t late_wakeups_{0};
    std::int64_t worst_late_ns_{0};
};

} // namespace gridspace::iec61850
