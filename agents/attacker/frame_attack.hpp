// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_window.hpp"
#include "common/random.hpp"

#include <cstdint>
#include <optional>

namespace gridspace::attacker {

/// What an attack does to the frames of a stream of sampled values; their currents stay as they are.
struct FrameAttackParams {
    enum class Kind {
        counter_jump, ///< smpCnt + jump: the clock of the merging unit, as a receiver sees it, is off by so many
                      ///< samples
        delay,        ///< delay_us later, in order; with a ramp it grows from nothing
        drop,         ///< drop_percent of the frames, `burst` in a row
        flood,        ///< copies of the newest frame, every interval_us
        synch,        ///< smpSynch says something else
    };
    Kind kind{Kind::drop};
    std::int64_t jump{0};
    double delay_us{0};
    double drop_percent{100};
    std::int64_t burst{1};
    double interval_us{20};
    std::int64_t smp_synch{0};
};

/// Decides about frames. Pure; the same seed, frames and times give the same outcome; no allocation.
class FrameAttack {
  public:
    /// Nanoseconds.
    FrameAttack(FrameAttackParams const& params, AttackTimes const& times, std::uint64_t seed)
        : params_{params}, window_{times}, random_{seed, "frames"}, next_copy_{window_.next(times.from)} {}

    struct Outcome {
        bool acts{false}; ///< something becomes of the frame that would not have
        bool dropped{false};
        std::int64_t delay_ns{0};
    };
    /// A frame passes.
    [[nodiscard]] Outcome pass(std::int64_t now_ns) {
        Outcome out;
        auto const start = window_.start(now_ns);
        if (params_.kind == FrameAttackParams::Kind::delay) {
            // Frames do not overtake each other, also where the delay ends.
            double const us = start ? params_.delay_us * window_.strength(*start, now_ns) : 0;
            last_out_ns_ = std::max(now_ns + static_cast<std::int64_t>(us * 1e3), last_out_ns_);
            out.delay_ns = last_out_ns_ - now_ns;
            out.acts = out.delay_ns > 0;
            return out;
        }
        if (!start || params_.kind == FrameAttackParams::Kind::flood) {
            return out;
        }
        out.dropped = params_.kind == FrameAttackParams::Kind::drop && is_dropped();
        out.acts = out.dropped || params_.kind != FrameAttackParams::Kind::drop;
        return out;
    }
    /// What it waits for has come.
    void trigger(std::int64_t now_ns) {
        if (window_.trigger(now_ns)) {
            next_copy_ = now_ns;
        }
    }
    /// Flood: when the next copy is due.
    [[nodiscard]] std::optional<std::int64_t> next_ns() const {
        return params_.kind == FrameAttackParams::Kind::flood ? next_copy_ : std::nullopt;
    }
    void copied() {
        next_copy_ =
            window_.next(*next_copy_ + std::max<std::int64_t>(static_cast<std::int64_t>(params_.interval_us * 1e3), 1));
    }
    [[nodiscard]] FrameAttackParams const& params() const { return params_; }

  private:
    [[nodiscard]] bool is_dropped() {
        if (dropping_ > 0) {
            --dropping_;
            return true;
        }
        // So many bursts that their frames are the wanted share of all.
        double const share = params_.drop_percent / 100, burst = static_cast<double>(params_.burst);
        if (!random_.chance(share / (share + burst * (1 - share)))) {
            return false;
        }
        dropping_ = params_.burst - 1;
        return true;
    }

    FrameAttackParams params_;
    AttackWindow window_;
    Random random_;
    std::optional<std::int64_t> next_copy_;
    std::int64_t dropping_{0}, last_out_ns_{0};
};

} // namespace gridspace::attacker
