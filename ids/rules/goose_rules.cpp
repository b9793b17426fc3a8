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

/// Whether (st, sq) of `a` comes after `b`. sqNum wraps to 1, stNum to 1.
bool newer(GooseFacts const& a, GooseFacts const& b) {
    return a.st_num != b.st_num ? a.st_num > b.st_num || (b.st_num == 0xFFFFFFFFU && a.st_num == 1)
                                : a.sq_num > b.sq_num || (b.sq_num == 0xFFFFFFFFU && a.sq_num == 1);
}

} // namespace

std::string goose_finding_names(std::uint32_t findings) {
    static constexpr std::array<char const*, 11> kNames{
        "wrong_source", "wrong_identity", "old",   "jump",      "old_time",     "clock",
        "simulated",    "commissioning",  "flood", "stretched", "silent_change"};
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
    if ((out.findings & ~kHarmless) == 0) {
        if (running_) {
            bool const confirms =
                held_ && newer(f, candidate_) && (f.st_num == candidate_.st_num || f.st_num == candidate_.st_num + 1);
            find(!newer(f, last_), kGooseOld);
            bool const jump = f.st_num > last_.st_num && f.st_num - last_.st_num > 1;
            if ((out.findings & kGooseOld) == 0 && jump && !confirms) {
                find(true, kGooseJump);
                held_ = true;
                candidate_ = f;
            } else if ((out.findings & kGooseOld) == 0 && !jump) {
                held_ = false; // the real publisher goes on where it was: the jump was forged
            }
            bool const same_state = f.st_num == last_.st_num;
            find(!same_state && f.t_ns < last_.t_ns && (out.findings & kGooseOld) == 0, kGooseOldTime);
            find(same_state && f.value_hash != last_.value_hash, kGooseSilentChange);
            find(params_.check_clock && !same_state && std::llabs(f.t_ns - f.arrival_ns) > kClockNs, kGooseClock);
        }
        if ((out.findings & ~kHarmless) == 0) {
            identity_ = bound_ ? identity_ : f;
            bound_ = running_ = true;
            held_ = false;
            last_ = f;
        }
    }
    out.accept = (out.findings & ~kHarmless) == 0;
    for (std::size_t k = 0; k < counters_.size(); ++k) {
        counters_[k] += (out.findings >> k) & 1U;
    }
    return out;
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
