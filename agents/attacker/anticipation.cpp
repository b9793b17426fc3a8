// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/anticipation.hpp"

#include "common/elementary.hpp"

#include <utility>

namespace gridspace::attacker {

Anticipation::Anticipation(SampleAttack attack)
    : attack_{std::move(attack)},
      factor_{2 * elementary::cos(6.283185307179586 * attack_.params().frequency_hz / attack_.params().rate_hz)} {}

void Anticipation::learn(std::int64_t index, Abc const& true_a) {
    in_row_ = last_index_ && index == *last_index_ + 1 ? in_row_ + 1 : 1;
    before_ = newest_;
    newest_ = true_a;
    last_index_ = index;
    next_index_ = index + 1;
    guess_newest_ = newest_;
    guess_before_ = before_;
}

std::optional<Anticipation::Forged> Anticipation::next() {
    if (in_row_ < 2) {
        return std::nullopt;
    }
    Abc guess;
    for (std::size_t p = 0; p < 3; ++p) {
        guess[p] = factor_ * guess_newest_[p] - guess_before_[p];
    }
    guess_before_ = guess_newest_;
    guess_newest_ = guess;
    Forged out;
    out.index = next_index_++;
    if (out.index <= applied_) { // guessed before: the attack has had its turn
        return Forged{out.index, guess, 0};
    }
    applied_ = out.index;
    SampleAttack::Outcome const outcome = attack_.apply(out.index, guess);
    out.sent_a = outcome.sent_a;
    out.altered = outcome.altered;
    return out;
}

} // namespace gridspace::attacker
