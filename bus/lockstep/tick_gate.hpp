// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/lockstep/ledger_book.hpp"
#include "bus/lockstep/wire_book.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::lockstep {

/// A member's side of the barrier: when may I start on tick k? When I hold clock k, the acknowledgements k of those
/// upstream members that are awaited in k, and every sample that their ledgers and the simulator's speak of. Of a late
/// one the acknowledgement of the tick before is enough: what it makes in k is due afterwards.
/// Pure: fed by the receiving threads under the owner's lock.
class TickGate {
  public:
    struct Config {
        std::string self;
        std::string simulator;             ///< the process that publishes the clock
        std::vector<std::string> members;  ///< all lockstep members; their sorted order numbers the awaited bits
        std::vector<std::string> upstream; ///< members whose output this one reads
        std::vector<std::string> late{};   ///< those of them whose output is due after the tick that it is made in
    };
    /// `wires`: the raw frames that this process receives; none: nullptr.
    TickGate(Config config, LedgerBook& book, WireBook const* wires = nullptr);

    /// Clock k: who is awaited in it, and whether it is the last. Ticks that do not await this member are only noted.
    void on_clock(std::uint64_t tick, std::span<std::uint8_t const> awaited, bool final);
    void on_ack(std::size_t process, std::uint64_t tick);

    struct Grant {
        std::uint64_t tick;
        bool final;
    };
    /// The tick to work on now; nothing while something is missing.
    [[nodiscard]] std::optional<Grant> granted() const;
    /// The pending tick has all its acknowledgements, and lacks samples that these speak of.
    [[nodiscard]] bool lacks_only_samples() const;
    /// The pending tick lacks nothing but raw frames that are announced.
    [[nodiscard]] bool lacks_only_frames() const;
    /// The work of the granted tick is done.
    void done() { pending_.reset(); }

    [[nodiscard]] bool has_pending() const { return pending_.has_value(); }
    [[nodiscard]] std::uint64_t latest_tick() const { return latest_; } ///< newest clock seen, awaited or not
    /// What a stuck member waits for, for people.
    [[nodiscard]] std::string awaiting() const;

  private:
    struct Upstream {
        std::size_t process{0}; ///< index in the book
        std::size_t member{0};  ///< index among the sorted members
        std::int64_t acked{-1};
        std::int64_t awaited{
            -1}; ///< newest tick in which it was awaited: nothing that it sent until then may be missed
        bool late{false};
        std::int64_t awaited_before{-1}; ///< the same, without the newest tick of all
        [[nodiscard]] bool is_here() const { return acked >= (late ? awaited_before : awaited); }
    };
    struct Pending {
        std::uint64_t tick;
        bool final;
    };

    [[nodiscard]] bool holds_acknowledgements() const;
    [[nodiscard]] bool holds_samples() const; ///< clock, acknowledgements and samples of the pending tick
    [[nodiscard]] bool holds_frames() const;

    LedgerBook& book_;
    WireBook const* wires_;
    std::size_t simulator_;
    std::optional<std::size_t> self_member_;
    std::vector<Upstream> upstream_;
    std::optional<Pending> pending_;
    std::uint64_t latest_{0};
};

[[nodiscard]] inline bool bit_of(std::span<std::uint8_t const> bits, std::size_t index) {
    return index / 8 < bits.size() && ((bits[index / 8] >> (index % 8)) & 1U) != 0;
}

} // namespace gridspace::lockstep
