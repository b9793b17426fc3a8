// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/rules/sv_rules.hpp"

#include <algorithm>
#include <cstdlib>

namespace gridspace::ids {

std::string sv_finding_names(std::uint32_t findings) {
    static constexpr std::array<char const*, 9> kNames{
        "wrong_source", "wrong_identity", "duplicate",   "out_of_order", "gap",
        "simulated",    "unsynchronised", "bad_arrival", "bad_counter"};
    std::string out;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
        if ((findings & (1U << k)) != 0) {
            out += (out.empty() ? "" : ", ") + std::string{kNames[k]};
        }
    }
    return out;
}

namespace {
constexpr std::uint32_t kRemembered = 64; ///< samples of which is known whether they came
} // namespace

SvRules::Verdict SvRules::judge(SvFacts const& f) {
    Verdict out;
    out.findings = strange(f);
    if (out.findings == 0) {
        follow(f, out);
    }
    out.accept = (out.findings &
                  (kWrongSource | kWrongIdentity | kDuplicate | kOutOfOrder | kSimulatedFrame | kBadCounter)) == 0;
    for (std::size_t k = 0; k < counters_.size(); ++k) {
        counters_[k] += (out.findings >> k) & 1U;
    }
    return out;
}

std::uint32_t SvRules::strange(SvFacts const& f) const {
    std::uint32_t out = f.smp_cnt >= params_.rate_hz ? static_cast<std::uint32_t>(kBadCounter) : 0U;
    out |= f.simulated && !params_.test_mode ? static_cast<std::uint32_t>(kSimulatedFrame) : 0U;
    if (bound_) {
        out |= f.source != identity_.source ? static_cast<std::uint32_t>(kWrongSource) : 0U;
        bool const same = f.app_id == identity_.app_id && f.vlan == identity_.vlan &&
                          f.sv_id_hash == identity_.sv_id_hash && f.conf_rev == identity_.conf_rev;
        out |= same ? 0U : static_cast<std::uint32_t>(kWrongIdentity);
    }
    return out;
}

void SvRules::follow(SvFacts const& f, Verdict& out) {
    std::uint32_t const rate = params_.rate_hz;
    bound_ = true;
    if (identity_.smp_synch > f.smp_synch && running_) {
        out.findings |= kUnsynchronised; // accepted: the relay blocks by itself, and has to know
    }
    identity_ = f;
    if (running_) {
        find_place(f.smp_cnt, out);
    }
    if ((out.findings & (kDuplicate | kOutOfOrder)) != 0) {
        int const frames = f.behind_another ? 0 : 1; // a frame of many samples that comes twice is one
        other_run_ = f.smp_cnt == other_next_ ? other_run_ + frames : 1;
        other_next_ = static_cast<std::uint16_t>((f.smp_cnt + 1U) % rate);
        // The publisher was restarted when its frames go on from there and nothing else comes.
        if (other_run_ < params_.resynchronise_after) {
            return;
        }
        out.findings &= ~static_cast<std::uint32_t>(kDuplicate | kOutOfOrder);
        out.resynchronised = true;
    }
    if (running_ && params_.check_arrival && !out.resynchronised && out.missing == 0 &&
        late_or_early(f.arrival_ns - last_arrival_ns_)) {
        out.findings |= kBadArrival;
    }
    std::uint32_t const step = (f.smp_cnt + rate - last_) % rate;
    bool const known = running_ && !out.resynchronised && step < kRemembered;
    seen_ = (known ? seen_ << step : 0U) | 1U;
    running_ = true;
    last_ = f.smp_cnt;
    last_arrival_ns_ = f.arrival_ns;
    other_run_ = 0;
}

void SvRules::find_place(std::uint16_t smp_cnt, Verdict& out) {
    std::uint32_t const rate = params_.rate_hz, ahead = (smp_cnt + rate - last_) % rate;
    // Half a second ahead cannot be told from half a second behind; frames of the last half second are old.
    bool const old = ahead == 0 || ahead > rate / 2;
    std::uint32_t const behind = ahead == 0 ? 0 : rate - ahead;
    std::uint64_t const bit = old && behind < kRemembered ? std::uint64_t{1} << behind : 0;
    if ((seen_ & bit) != 0) {
        out.findings |= kDuplicate;
    } else if (old) {
        out.findings |= kOutOfOrder;
        seen_ |= bit;
    } else if (ahead > 1) {
        out.findings |= kGap;
        out.missing = ahead - 1;
    }
}

bool SvRules::late_or_early(std::int64_t interval_ns) {
    constexpr std::size_t kRenewAfter =
        16; // what is usual changes slowly, and sorting for each frame would cost a microsecond
    if (interval_count_ >= intervals_.size() && interval_count_ % kRenewAfter == 0) {
        std::array<std::int64_t, 64> sorted = intervals_;
        std::nth_element(sorted.begin(), sorted.begin() + 32, sorted.end());
        usual_ns_ = sorted[32];
        for (std::int64_t& x : sorted) {
            x = std::llabs(x - usual_ns_);
        }
        std::nth_element(sorted.begin(), sorted.begin() + 32, sorted.end());
        allowed_ns_ = std::max<std::int64_t>(6 * sorted[32], 500'000'000 / params_.rate_hz);
    }
    bool const odd = interval_count_ >= intervals_.size() && std::llabs(interval_ns - usual_ns_) > allowed_ns_;
    intervals_[interval_count_++ % intervals_.size()] = interval_ns;
    return odd;
}

} // namespace gridspace::ids
