// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/sv.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <optional>
#include <vector>

namespace gridspace::iec61850 {

/// Two clocks count the same instants when both are global, or both local and the same (an identity of 5 to 254 names
/// one).
[[nodiscard]] constexpr bool same_clock(std::uint8_t a, std::uint8_t b) noexcept {
    return a == b && (a == kLocalClock || a == kGlobalClock || a >= 5);
}

/// What two streams say about one instant. A member that is empty was lost or came too late.
template <class T>
struct AlignedPair {
    std::int64_t index{
        0}; ///< congruent to smpCnt; negative just before the second in which the first stream was heard first
    std::optional<T> first, second;
    std::uint8_t first_synch{0}, second_synch{0}; ///< of the newest sample when the member is empty
    [[nodiscard]] bool coherent() const noexcept { return same_clock(first_synch, second_synch); }
};

/// Puts the samples of two streams side by side by their counters, never by their arrival. A pair comes out when both
/// are there; or one alone when its partner's stream is already past it, or `timeout_ns` after it came. Pairs come out
/// in order, each index once. Samples that come later than that are counted and dropped. A stream may be past a sample
/// that was only overtaken: where more holes follow each other than their reader bridges, they wait for it a little.
/// Allocates nothing after construction.
template <class T>
class StreamAlignment {
  public:
    struct Counters {
        std::uint64_t pairs{0}, first_missing{0}, second_missing{0}, too_late{0}, restarts{0};
    };

    /// How long holes stay open, in a run of more than `bridged`, behind the arrival of what went past them.
    struct Overtaking {
        std::int64_t wait_ns{0};
        std::int64_t bridged{0};
    };

    /// `held_back`: a pair waits until both streams are so many samples past it (or for the timeout), so that what is
    /// said about it meanwhile, waiting(), still counts. `wrap` is also the samples of a second, where counters count
    /// those: room is made for all that comes of one stream within the timeout, and some more.
    StreamAlignment(std::int64_t timeout_ns, std::uint32_t wrap, std::int64_t held_back = 0, Overtaking overtaking = {})
        : timeout_ns_{timeout_ns}, wrap_{wrap}, held_back_{held_back}, overtaking_{overtaking},
          slots_(capacity_for(timeout_ns, wrap)) {}

    /// So many samples of one stream can wait for the other.
    [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

    /// The sample of `stream` with this counter, while it has not been given out; nullptr otherwise.
    [[nodiscard]] T* waiting(std::size_t stream, std::uint16_t smp_cnt) noexcept {
        if (!next_ || !ends_[stream].started) {
            return nullptr;
        }
        std::int64_t const index = congruent(smp_cnt, ends_[stream].newest);
        Slot& slot = slot_of(index);
        return slot.index == index && slot.values[stream] ? &*slot.values[stream] : nullptr;
    }

    /// How a sample goes on from the newest one of its stream, as its subscriber judges it.
    struct Step {
        std::int64_t samples{1}; ///< not above 0: it came late
        bool restarted{false};   ///< the first of the stream, or behind a jump of its counter
    };

    /// Sample `smp_cnt` of stream 0 or 1. After a silence of half a wrap or more the counter alone does not say which
    /// sample it is: the step does.
    void push(std::size_t stream, std::uint16_t smp_cnt, std::uint8_t synch, T const& value, std::int64_t now_ns,
              Step step = {}) noexcept {
        End& end = ends_[stream];
        bool const restarted = step.restarted;
        std::int64_t const index = congruent(smp_cnt, near(stream, smp_cnt, now_ns, step));
        end.heard_ns = now_ns;
        if (!next_) {
            next_ = index;
        }
        if (restarted || !end.started || index >= end.newest) {
            end.synch = synch;
        }
        if (restarted && end.started) {
            ++counters_.restarts;
        }
        if (index < *next_) {
            if (!emitted_ && *next_ - index < static_cast<std::int64_t>(capacity() / 2)) {
                next_ = index; // the very first pairs: the other stream was heard first, but is ahead
            } else {
                ++counters_.too_late;
                end.started = true;
                end.newest = std::max(end.newest, index);
                return;
            }
        }
        if (index - *next_ >= static_cast<std::int64_t>(capacity())) { // far ahead of what is kept: begin anew there
            clear();
            next_ = index;
            ++counters_.restarts;
        }
        Slot& slot = slot_of(index);
        if (slot.index != index) {
            slot = {};
            slot.index = index;
            slot.arrived_ns = now_ns;
        }
        slot.came_ns[stream] = now_ns;
        slot.values[stream] = value;
        slot.synch[stream] = synch;
        end.newest = end.started ? std::max(end.newest, index) : index;
        end.started = true;
    }

    /// The next pair that can be given out, or nothing yet.
    [[nodiscard]] std::optional<AlignedPair<T>> pop(std::int64_t now_ns) noexcept {
        if (!next_) {
            return std::nullopt;
        }
        Slot& slot = slot_of(*next_);
        bool const here = slot.index == *next_;
        bool const both = here && slot.values[0] && slot.values[1] &&
                          std::min(ends_[0].newest, ends_[1].newest) - *next_ >= held_back_;
        if (!both && !past(now_ns)) {
            return std::nullopt;
        }
        AlignedPair<T> pair{*next_, {}, {}, ends_[0].synch, ends_[1].synch};
        if (here) {
            pair.first = slot.values[0];
            pair.second = slot.values[1];
            pair.first_synch = slot.values[0] ? slot.synch[0] : ends_[0].synch;
            pair.second_synch = slot.values[1] ? slot.synch[1] : ends_[1].synch;
            slot.index = kNone;
        }
        counters_.first_missing += pair.first ? 0 : 1;
        counters_.second_missing += pair.second ? 0 : 1;
        ++counters_.pairs;
        holes_ = pair.first && pair.second ? 0 : holes_ + 1;
        ++*next_;
        emitted_ = true;
        return pair;
    }

    /// When pop() would give something without another sample; nothing when it would not.
    [[nodiscard]] std::optional<std::int64_t> deadline() const noexcept {
        if (!next_) {
            return std::nullopt;
        }
        for (std::int64_t i = *next_; i <= std::max(ends_[0].newest, ends_[1].newest); ++i) {
            Slot const& slot = slot_of(i);
            if (slot.index == i) {
                auto const open = stays_open();
                return open ? std::min(open->until_ns, slot.arrived_ns + timeout_ns_) : slot.arrived_ns + timeout_ns_;
            }
        }
        return std::nullopt;
    }

    [[nodiscard]] Counters const& counters() const noexcept { return counters_; }

  private:
    static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::min();
    struct Slot {
        std::int64_t index{kNone};
        std::int64_t arrived_ns{0}; ///< the first of the two
        std::array<std::int64_t, 2> came_ns{};
        std::array<std::optional<T>, 2> values;
        std::array<std::uint8_t, 2> synch{};
    };
    struct End {
        bool started{false};
        std::int64_t newest{0}, heard_ns{0};
        std::uint8_t synch{0};
    };

    /// A stream that is alone is given out when it has waited for the timeout; until then it must be kept.
    [[nodiscard]] static std::size_t capacity_for(std::int64_t timeout_ns, std::uint32_t samples_per_s) noexcept {
        auto const waiting = static_cast<double>(timeout_ns) * 1e-9 * static_cast<double>(samples_per_s);
        return std::bit_ceil(std::max<std::size_t>(256, static_cast<std::size_t>(1.25 * waiting) + 64));
    }
    [[nodiscard]] Slot& slot_of(std::int64_t index) noexcept {
        return slots_[static_cast<std::size_t>(index) & (slots_.size() - 1)];
    }
    [[nodiscard]] Slot const& slot_of(std::int64_t index) const noexcept {
        return slots_[static_cast<std::size_t>(index) & (slots_.size() - 1)];
    }

    /// About which index a sample has.
    [[nodiscard]] std::int64_t near(std::size_t stream, std::uint16_t smp_cnt, std::int64_t now_ns,
                                    Step step) const noexcept {
        End const &end = ends_[stream], &other = ends_[1 - stream];
        if (!end.started) {
            return other.started ? other.newest : std::int64_t{smp_cnt};
        }
        // A partner that is silent too says nothing about now.
        bool const joins = step.restarted && other.started && now_ns - other.heard_ns <= timeout_ns_;
        return joins ? other.newest : end.newest + step.samples;
    }

    [[nodiscard]] std::int64_t congruent(std::int64_t value, std::int64_t near) const noexcept {
        std::int64_t const wrap = wrap_;
        std::int64_t difference = (value - near) % wrap;
        difference += difference < 0 ? wrap : 0;
        return near + difference - (2 * difference > wrap ? wrap : 0);
    }

    /// Nothing more will come for the next index: both streams are past it, or what is behind it has waited long
    /// enough.
    [[nodiscard]] bool past(std::int64_t now_ns) noexcept {
        if (both_went_on()) {
            auto const open = stays_open();
            if (!open) {
                return true;
            }
            kept_open_ = open->behind; // all of it, also when it fills one by one
            if (now_ns >= open->until_ns) {
                given_up_ = open->behind;
                return true;
            }
        }
        auto const at = deadline();
        return at && now_ns >= *at;
    }

    [[nodiscard]] bool has(std::size_t stream, std::int64_t index) const noexcept {
        Slot const& slot = slot_of(index);
        return slot.index == index && slot.values[stream].has_value();
    }
    /// Of each stream the next sample is there, or a later one.
    [[nodiscard]] bool both_went_on() const noexcept {
        auto const went_on = [this](std::size_t s) {
            return has(s, *next_) || (ends_[s].started && ends_[s].newest > *next_);
        };
        return went_on(0) && went_on(1) && std::min(ends_[0].newest, ends_[1].newest) - *next_ >= held_back_;
    }
    /// A stream is past this index, and its sample is not there.
    [[nodiscard]] bool is_hole(std::int64_t index) const noexcept {
        return (!has(0, index) && ends_[0].started && ends_[0].newest > index) ||
               (!has(1, index) && ends_[1].started && ends_[1].newest > index);
    }

    struct Open {
        std::int64_t until_ns;
        std::int64_t behind; ///< the first index that came behind the hole
    };
    /// Whether the next index is a hole that a late sample may still fill, and until when.
    [[nodiscard]] std::optional<Open> stays_open() const noexcept {
        if (overtaking_.wait_ns == 0 || !both_went_on() || !is_hole(*next_) || *next_ < given_up_) {
            return std::nullopt;
        }
        std::int64_t run = holes_;
        for (std::int64_t i = *next_; *next_ >= kept_open_ && run <= overtaking_.bridged; ++i, ++run) {
            if (!is_hole(i)) {
                return std::nullopt;
            }
        }
        std::optional<Open> out;
        for (std::size_t stream = 0; stream < 2; ++stream) {
            for (std::int64_t i = *next_; !has(stream, *next_) && i <= ends_[stream].newest; ++i) {
                if (has(stream, i)) {
                    std::int64_t const until = slot_of(i).came_ns[stream] + overtaking_.wait_ns;
                    out = Open{out ? std::max(out->until_ns, until) : until, out ? std::min(out->behind, i) : i};
                    break;
                }
            }
        }
        return out;
    }

    void clear() noexcept {
        for (Slot& slot : slots_) {
            slot.index = kNone;
        }
        holes_ = 0;
    }

    std::int64_t timeout_ns_;
    std::uint32_t wrap_;
    std::int64_t held_back_;
    Overtaking overtaking_;
    std::vector<Slot> slots_; ///< a power of two
    std::array<End, 2> ends_{};
    std::optional<std::int64_t> next_;
    std::int64_t holes_{0};                           ///< given out one behind the other
    std::int64_t kept_open_{kNone}, given_up_{kNone}; ///< holes before this index wait; have waited
    bool emitted_{false};
    Counters counters_;
};

/// Bridges single lost samples by the last one; more in a row are invalid until `recover` good samples have come.
class SampleHold {
  public:
    SampleHold(std::uint32_t max_held, std::uint32_t recover) noexcept : max_held_{max_held}, recover_{recover} {}

    enum class State : std::uint8_t { good, held, invalid };
    /// One sample of the stream is there and usable, or not.
    State step(bool usable) noexcept {
        if (usable) {
            missing_ = 0;
            good_ = good_ < recover_ ? good_ + 1 : good_;
            if (invalid_ && good_ >= recover_) {
                invalid_ = false;
            }
            return invalid_ ? State::invalid : State::good;
        }
        good_ = 0;
        missing_ = missing_ <= max_held_ ? missing_ + 1 : missing_;
        invalid_ = invalid_ || missing_ > max_held_;
        return invalid_ ? State::invalid : State::held;
    }

  private:
    std::uint32_t max_held_, recover_;
    std::uint32_t missing_{0}, good_{0};
    bool invalid_{true}; ///< nothing good has come yet
};

} // namespace gridspace::iec61850
