// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::lockstep {

/// The simulator's side of the barrier: who is awaited in tick k, and have they all acknowledged it?
///
/// Awaited are the members that asked for the tick (next_tick_needed), those that have not acknowledged for max_lag
/// ticks (so that nobody's inbox overflows) or, who collect frames, since kMostFrames were sent (so that no ring
/// does), those for whom a late member has made something in the last tick, and everybody who is triggered, directly
/// or not, by one of these. The set depends on acknowledgements only, never on wall time, so skipping idle members
/// does not change a run. Pure.
class Barrier {
  public:
    struct Member {
        std::string name;
        std::vector<std::string> triggered_by; ///< members whose output makes this one work in the same tick
        std::vector<std::string> late{};       ///< members whose output makes this one work in the next tick
        bool collects_frames{false};           ///< it leaves frames where they arrive until it works
    };
    /// A quarter of what a port keeps, which recorder/app/frame_capture.cpp checks.
    static constexpr std::uint64_t kMostFrames = 1024;
    Barrier(std::vector<Member> members, std::uint64_t max_lag);

    /// Opens tick k (k counts up by one). `everybody`: the first and the last tick.
    void open(std::uint64_t tick, bool everybody);
    [[nodiscard]] std::uint64_t tick() const { return tick_; }
    [[nodiscard]] bool anybody_awaited() const { return awaited_count_ > 0; }
    [[nodiscard]] std::vector<std::uint8_t> const& awaited_bits() const { return bits_; }

    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    [[nodiscard]] std::size_t member_index(std::string_view name) const;
    [[nodiscard]] std::string const& member_name(std::size_t index) const { return members_[index].name; }
    [[nodiscard]] std::size_t size() const { return members_.size(); }

    /// `frames`: so many it has sent; who hears it late will find them in the next tick. False, and not taken: a tick
    /// that is still to come.
    [[nodiscard]] bool on_ack(std::size_t member, std::uint64_t tick, std::uint64_t next_tick_needed,
                              std::uint64_t frames = 0);
    /// The member is not awaited any more (the scenario lets the run go on without it).
    void drop(std::size_t member);
    /// A new incarnation of the member joined: it is awaited from the next tick on.
    void rejoin(std::size_t member);

    [[nodiscard]] bool complete() const { return open_acks_ == 0; }
    [[nodiscard]] std::vector<std::size_t> missing() const; ///< members that have not acknowledged the open tick
    [[nodiscard]] std::optional<std::uint64_t> last_ack(std::size_t member) const;

  private:
    struct State {
        std::string name;
        std::vector<std::size_t> triggers; ///< members that this one triggers
        std::vector<std::size_t> triggers_late{};
        std::int64_t acked{-1};
        std::uint64_t next_needed{0};
        bool awaited{false};
        bool dropped{false};
        bool has_sent{false}; ///< in the open tick
        bool collects_frames{false};
        std::uint64_t frames_before{0}; ///< of all members, up to the tick that it acknowledged last
    };
    void await(std::size_t member);

    std::vector<State> members_;
    std::vector<std::uint8_t> bits_;
    std::vector<std::size_t> stack_, late_;
    std::uint64_t max_lag_;
    std::uint64_t tick_{0};
    std::size_t awaited_count_{0};
    std::size_t open_acks_{0};
    std::uint64_t frames_{0}; ///< of all members
};

} // namespace gridspace::lockstep
