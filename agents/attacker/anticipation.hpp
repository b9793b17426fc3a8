// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/sample_attack.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace gridspace::attacker {

/// What a second publisher needs: a receiver takes the first frame of a sample, so the forged sample must be out
/// before the real one, and the truth is not known yet. The next samples are guessed from the last two (a sinusoid of
/// the nominal frequency), and the attack alters the guess. Labels are given when the real sample comes and the truth
/// is known. No allocation per sample.
class Anticipation {
  public:
    explicit Anticipation(SampleAttack attack);

    /// The real sample of `index`; `tell(Label)` for each phase of it that was forged. An index that is not newer than
    /// the last one is ignored.
    template <class Tell>
    void real(std::int64_t index, Abc const& true_a, Tell&& tell) {
        if (last_index_ && index <= *last_index_) {
            return;
        }
        Forged& forged = pending_[static_cast<std::size_t>(index) % pending_.size()];
        if (forged.index == index && forged.altered != 0) {
            labels_of(index, true_a, {forged.sent_a, forged.altered}, tell);
            forged.altered = 0;
        }
        learn(index, true_a);
    }

    struct Forged {
        std::int64_t index{-1};
        Abc sent_a{};
        std::uint8_t altered{0}; ///< 0: the attack leaves this sample alone
    };
    /// What the sample after the last real or forged one is to be; nothing before two real ones in a row were heard.
    [[nodiscard]] std::optional<Forged> next();
    /// What was really sent, after rounding to the type of the stream.
    void sent(Forged const& forged) { pending_[static_cast<std::size_t>(forged.index) % pending_.size()] = forged; }

    /// What the attack waits for has come.
    void trigger() { attack_.trigger(); }

    [[nodiscard]] SampleAttack const& attack() const { return attack_; }

  private:
    void learn(std::int64_t index, Abc const& true_a);

    SampleAttack attack_;
    double factor_; ///< 2 cos(w)
    std::optional<std::int64_t> last_index_;
    std::int64_t next_index_{0}, applied_{-1};
    int in_row_{0};
    Abc newest_{}, before_{};             ///< real
    Abc guess_newest_{}, guess_before_{}; ///< real, then guessed
    std::array<Forged, 64> pending_{};
};

} // namespace gridspace::attacker
