// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/rules/goose_rules.hpp"

#include <algorithm>
#include <cstdlib>

namespace gridspace::ids {
namespace {

/// Alarms that refuse nothing: the content is good, and refusing under a flood would do the attacker's work.
constexpr std::uint32_t kHarmless = kGooseStretched | kGooseFlood;
constexpr std::int64_t kClockNs = 2'000'000'000;

/// Whether sqNum `a` comes after `b`; it wraps to 1.
bool later(std::uint32_t a, std::uint32_t b) {
    return a > b || (b == 0xFFFFFFFFU && a == 1);
}

bool is_next(std::uint32_t st_num, std::uint32_t after) {
    return st_num == (after == 0xFFFFFFFFU ? 1 : after + 1);
}

} // namespace

std::string goose_finding_names(std::uint32_t findings) {
    static constexpr std::array<char const*, kGooseFindings> kNames{
        "wrong_source", "wrong_identity", "old",   "jump",      "old_time",      "clock",
        "simulated",    "commissioning",  "flood", "stretched", "silent_change", "contest"};
    std::string out;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
        if ((findings & (1U << k)) != 0) {
            out += (out.empty() ? "" : ", ") + std::string{kNames[k]};
        }
    }
    return out;
}

GooseRules::Verdict GooseRules::judge(GooseFacts const& f) {
    Verdict out;
    auto const find = [&](bool is, GooseFinding what) { out.findings |= is ? static_cast<std::uint32_t>(what) : 0U; };
    find(flooded(f.arrival_ns), kGooseFlood);
    find(f.simulated && !params_.test_mode, kGooseSimulated);
    find(f.needs_commissioning, kGooseCommissioning);
    if (bound_) {
        find(f.source != identity_.source, kGooseWrongSource);
        find(f.app_id != identity_.app_id || f.vlan != identity_.vlan || f.identity_hash != identity_.identity_hash ||
                 f.conf_rev != identity_.conf_rev || f.entries != identity_.entries,
             kGooseWrongIdentity);
        find(f.live_ms > 3 * std::max({static_cast<double>(identity_.live_ms), params_.longest_live_ms, 1.0}),
             kGooseStretched);
    }
    bool begins = false;
    if ((out.findings & ~kHarmless) == 0) {
        if (!running_) {
            known_count_ = 0;
            has_jump_ = has_rival_ = false;
            contested_until_ns_ = INT64_MIN;
            begins = true;
        } else {
            out.findings |= judge_counters(f, begins);
        }
        out.accept = (out.findings & ~kHarmless) == 0;
        constexpr std::uint32_t kSettledByContest = kGooseOld | kGooseJump | kGooseOldTime | kGooseContest;
        out.contested = !out.accept && begins && params_.accept_in_contest && f.arrival_ns <= contested_until_ns_ &&
                        (out.findings & ~(kHarmless | kSettledByContest)) == 0;
        out.accept = out.accept || out.contested;
        if (out.accept) {
            identity_ = bound_ ? identity_ : f;
            bound_ = running_ = true;
            if (begins) {
                enter(f);
            }
        }
    } else {
        out.accept = false;
    }
    for (std::size_t k = 0; k < counters_.size(); ++k) {
        counters_[k] += (out.findings >> k) & 1U;
    }
    return out;
}

std::uint32_t GooseRules::judge_counters(GooseFacts const& f, bool& begins) {
    std::uint32_t out = 0;
    bool contest = false;
    State const& now = known_[current_];
    auto const known = std::find_if(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(known_count_),
                                    [&](State const& s) { return s.is_of(f); });
    if (known != known_.begin() + static_cast<std::ptrdiff_t>(known_count_)) {
        if (!later(f.sq_num, known->sq_num)) {
            return kGooseOld; // a replay, or a copy
        }
        contest = known !=
                  known_.begin() + static_cast<std::ptrdiff_t>(current_); // somebody goes on in a state that has ended
        known->sq_num = f.sq_num;
        known->live_ms = f.live_ms;
        known->arrival_ns = f.arrival_ns;
        out |= contest ? kGooseOld : 0U;
    } else if (f.st_num == now.st_num && f.t_ns == now.t_ns) {
        return kGooseSilentChange;
    } else {
        begins = true;
        bool const next = is_next(f.st_num, now.st_num);
        if (!next && f.st_num > now.st_num) {
            out |= has_jump_ && jump_.runs_at(f.arrival_ns) && jump_.precedes(f)
                       ? 0U
                       : static_cast<std::uint32_t>(kGooseJump);
            jump_ = state_of(f);
            has_jump_ = true;
        } else if (!next) {
            // Older than anything held it may be a replay: then only a second one that goes on from it counts.
            auto const first =
                std::min_element(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(known_count_),
                                 [](State const& a, State const& b) { return a.order < b.order; });
            contest = f.t_ns > first->t_ns || (has_rival_ && rival_.runs_at(f.arrival_ns) && rival_.precedes(f));
            begins = contest;
            rival_ = state_of(f);
            has_rival_ = true;
            out |= kGooseOld;
        }
        out |= f.t_ns < now.t_ns && (out & kGooseOld) == 0 ? kGooseOldTime : 0U;
        out |= params_.check_clock && std::llabs(f.t_ns - f.arrival_ns) > kClockNs ? kGooseClock : 0U;
    }
    if (contest) {
        std::int64_t const live_ms = std::max({f.live_ms, now.live_ms, identity_.live_ms});
        contested_until_ns_ = f.arrival_ns + 2 * live_ms * 1'000'000;
    }
    return out | (contest ? kGooseContest : 0U);
}

bool GooseRules::State::precedes(GooseFacts const& f) const {
    return is_next(f.st_num, st_num) || (is_of(f) && later(f.sq_num, sq_num));
}

GooseRules::State GooseRules::state_of(GooseFacts const& f) {
    return {f.st_num, f.sq_num, f.live_ms, f.t_ns, f.arrival_ns, f.value_hash, 0};
}

void GooseRules::enter(GooseFacts const& f) {
    auto const end = known_.begin() + static_cast<std::ptrdiff_t>(known_count_);
    auto at = end;
    if (known_count_ < known_.size()) {
        ++known_count_;
    } else {
        // The earliest of those that have run out; else the latest: who was here first and goes on is never pushed out.
        at = std::min_element(known_.begin(), end, [&](State const& a, State const& b) {
            bool const a_runs = a.runs_at(f.arrival_ns), b_runs = b.runs_at(f.arrival_ns);
            return a_runs != b_runs ? b_runs : a_runs ? a.order > b.order : a.order < b.order;
        });
    }
    *at = state_of(f);
    at->order = order_++;
    current_ = static_cast<std::size_t>(at - known_.begin());
}

/// A bucket of tokens: `burst` at once, and one for each shortest retransmission interval.
bool GooseRules::flooded(std::int64_t now_ns) {
    if (counted_) {
        tokens_ +=
            static_cast<double>(std::max<std::int64_t>(now_ns - last_token_ns_, 0)) / (params_.min_time_ms * 1e6);
        tokens_ = std::min(tokens_, static_cast<double>(params_.burst));
    }
    counted_ = true;
    last_token_ns_ = now_ns;
    if (tokens_ < 1) {
        return true;
    }
    tokens_ -= 1;
    return false;
}

} // namespace gridspace::ids
