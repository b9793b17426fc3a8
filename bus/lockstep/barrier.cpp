// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/barrier.hpp"

#include <algorithm>
#include <utility>

namespace gridspace::lockstep {

Barrier::Barrier(std::vector<Member> members, std::uint64_t max_lag) : max_lag_{std::max<std::uint64_t>(1, max_lag)} {
    std::sort(members.begin(), members.end(), [](Member const& a, Member const& b) { return a.name < b.name; });
    for (Member const& member : members) {
        members_.push_back({.name = member.name, .triggers = {}, .collects_frames = member.collects_frames});
    }
    for (std::size_t i = 0; i < members.size(); ++i) {
        for (std::string const& trigger : members[i].triggered_by) {
            if (std::size_t const source = member_index(trigger); source != kUnknown) {
                members_[source].triggers.push_back(i);
            }
        }
        for (std::string const& trigger : members[i].late) {
            if (std::size_t const source = member_index(trigger); source != kUnknown) {
                members_[source].triggers_late.push_back(i);
            }
        }
    }
    bits_.resize((members_.size() + 7) / 8);
    stack_.reserve(members_.size());
    late_.reserve(members_.size() * members_.size());
}

std::size_t Barrier::member_index(std::string_view name) const {
    auto const it = std::lower_bound(members_.begin(), members_.end(), name,
                                     [](State const& m, std::string_view wanted) { return m.name < wanted; });
    return it != members_.end() && it->name == name ? static_cast<std::size_t>(it - members_.begin()) : kUnknown;
}

void Barrier::await(std::size_t member) {
    // Everybody triggered by `member`, directly or through others.
    stack_.push_back(member);
    while (!stack_.empty()) {
        std::size_t const next = stack_.back();
        stack_.pop_back();
        State& state = members_[next];
        if (state.awaited || state.dropped) {
            continue;
        }
        state.awaited = true;
        bits_[next / 8] = static_cast<std::uint8_t>(bits_[next / 8] | (1U << (next % 8)));
        ++awaited_count_;
        stack_.insert(stack_.end(), state.triggers.begin(), state.triggers.end());
    }
}

void Barrier::open(std::uint64_t tick, bool everybody) {
    awaited_count_ = 0;
    std::fill(bits_.begin(), bits_.end(), std::uint8_t{0});
    late_.clear();
    for (State& state : members_) {
        state.awaited = false;
        if (state.acked == static_cast<std::int64_t>(tick_)) { // here, where those of all are counted
            state.frames_before = frames_;
        }
        if (std::exchange(state.has_sent, false)) {
            late_.insert(late_.end(), state.triggers_late.begin(), state.triggers_late.end());
        }
    }
    tick_ = tick;
    for (std::size_t const member : late_) {
        await(member);
    }
    for (std::size_t i = 0; i < members_.size(); ++i) {
        State const& state = members_[i];
        bool const lagging = static_cast<std::int64_t>(tick) - state.acked >= static_cast<std::int64_t>(max_lag_) ||
                             (state.collects_frames && frames_ - state.frames_before >= kMostFrames);
        if (everybody || lagging || state.next_needed <= tick) {
            await(i);
        }
    }
    open_acks_ = awaited_count_;
}

bool Barrier::on_ack(std::size_t member, std::uint64_t tick, std::uint64_t next_tick_needed, std::uint64_t frames) {
    State& state = members_[member];
    if (tick > tick_) {
        return false;
    }
    if (static_cast<std::int64_t>(tick) <= state.acked) {
        return true;
    }
    state.acked = static_cast<std::int64_t>(tick);
    state.has_sent = frames > 0;
    frames_ += frames;
    state.next_needed = std::max(next_tick_needed, tick + 1);
    if (tick == tick_ && state.awaited) {
        --open_acks_;
    }
    return true;
}

void Barrier::drop(std::size_t member) {
    State& state = members_[member];
    if (state.awaited && state.acked < static_cast<std::int64_t>(tick_)) {
        --open_acks_;
    }
    state.awaited = false; // its acknowledgement may still come, and counts for nothing
    state.dropped = true;
}

void Barrier::rejoin(std::size_t member) {
    State& state = members_[member];
    state.dropped = false;
    state.next_needed = tick_ + 1;
}

std::vector<std::size_t> Barrier::missing() const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < members_.size(); ++i) {
        State const& state = members_[i];
        if (state.awaited && state.acked < static_cast<std::int64_t>(tick_)) {
            out.push_back(i);
        }
    }
    return out;
}

std::optional<std::uint64_t> Barrier::last_ack(std::size_t member) const {
    std::int64_t const acked = members_[member].acked;
    return acked < 0 ? std::nullopt : std::optional{static_cast<std::uint64_t>(acked)};
}

} // namespace gridspace::lockstep
