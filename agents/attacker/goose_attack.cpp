// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/goose_attack.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::attacker {
namespace {

AttackTimes waiting(AttackTimes times, bool waits) {
    times.waits = times.waits || waits;
    return times;
}

} // namespace

GooseAttack::GooseAttack(GooseAttackParams const& params, AttackTimes const& times, std::uint64_t seed)
    : params_{params}, window_{waiting(times, params.said.has_value())}, next_ns_{window_.next(times.from)},
      random_{seed, "goose"} {}

bool GooseAttack::only_alters() const {
    return params_.kind == GooseAttackParams::Kind::grayhole || params_.kind == GooseAttackParams::Kind::stretch;
}

std::optional<GooseState> GooseAttack::pass(std::int64_t now_ns, GooseState const& real) {
    heard_[heard_count_++ % heard_.size()] = real;
    if (params_.said == real.value) {
        trigger(now_ns);
    }
    if (!window_.acts(now_ns)) {
        return real;
    }
    if (params_.kind == GooseAttackParams::Kind::grayhole && random_.chance(params_.drop_percent / 100)) {
        ++dropped_;
        return std::nullopt;
    }
    GooseState out = real;
    if (params_.kind == GooseAttackParams::Kind::stretch) {
        out.live_ms = 60'000;
        ++forged_;
    }
    return out;
}

std::optional<std::int64_t> GooseAttack::next_ns() const {
    return only_alters() ? std::nullopt : next_ns_;
}

std::optional<GooseState> GooseAttack::forge(std::int64_t now_ns) {
    if (only_alters() || !next_ns_ || now_ns < *next_ns_) {
        return std::nullopt;
    }
    next_ns_ = window_.next(*next_ns_ + std::max<std::int64_t>(std::llround(params_.interval_ms * 1e6), 1));
    if (heard_count_ == 0) {
        return std::nullopt;
    }
    ++forged_;
    return make(now_ns);
}

GooseState GooseAttack::make(std::int64_t now_ns) {
    std::size_t const kept = std::min(heard_count_, heard_.size());
    GooseState const latest = heard_[(heard_count_ - 1) % heard_.size()];
    GooseState out = latest;
    switch (params_.kind) {
    case GooseAttackParams::Kind::random_replay:
        return heard_[random_.below(kept)];
    case GooseAttackParams::Kind::inverse_replay: {
        for (std::size_t k = 1; k <= kept; ++k) { // the newest with the other value; else the oldest
            GooseState const& old = heard_[(heard_count_ - k) % heard_.size()];
            if (old.value != latest.value) {
                return old;
            }
        }
        return heard_[(heard_count_ - kept) % heard_.size()];
    }
    case GooseAttackParams::Kind::masquerade_trip:
    case GooseAttackParams::Kind::masquerade_normal: {
        bool const value = params_.kind == GooseAttackParams::Kind::masquerade_trip;
        if (!own_ || own_->st_num <= latest.st_num) {
            own_ = latest;
            own_->st_num = latest.st_num + 1;
            own_->sq_num = 0;
            own_->t_ns = now_ns;
            own_->value = value;
        } else {
            ++own_->sq_num;
        }
        return *own_;
    }
    case GooseAttackParams::Kind::injection:
        out.st_num += static_cast<std::uint32_t>(random_.below(3));
        out.sq_num = static_cast<std::uint32_t>(random_.below(1000));
        out.t_ns = now_ns;
        out.value = random_.chance(0.5);
        return out;
    case GooseAttackParams::Kind::high_st_num:
        out.st_num = latest.st_num > 0xFFFFFFFFU - params_.jump ? 0xFFFFFFFFU : latest.st_num + params_.jump;
        out.sq_num = 0;
        out.t_ns = now_ns;
        return out;
    case GooseAttackParams::Kind::flooding:
        return out;
    case GooseAttackParams::Kind::simulation:
        out.simulated = true;
        return out;
    case GooseAttackParams::Kind::grayhole:
    case GooseAttackParams::Kind::stretch:
        return out;
    }
    return out;
}

} // namespace gridspace::attacker
