// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_window.hpp"
#include "common/random.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace gridspace::attacker {

/// What an attacker needs to know about a GOOSE message, and what he decides about one of his own. Times in nanoseconds
/// of simulated time.
struct GooseState {
    std::uint32_t st_num{1}, sq_num{0};
    std::int64_t t_ns{0};     ///< time of the last change of state
    std::uint32_t live_ms{0}; ///< time allowed to live
    bool value{false};        ///< of the attacked Boolean
    bool simulated{false};

    friend bool operator==(GooseState const&, GooseState const&) = default;
};

/// The attack catalogue of the ERENO data sets (random and inverse replay, masquerade, injection, high state number,
/// flooding, grayhole), and two on the header.
struct GooseAttackParams {
    enum class Kind {
        random_replay,     ///< an old message, as it was
        inverse_replay,    ///< an old message with the opposite value, as it was: "trip" after a reset
        masquerade_trip,   ///< the next state, value true: a fault that is not there
        masquerade_normal, ///< the next state, value false: hides a trip
        injection,         ///< random value with counters near the real ones
        high_st_num,       ///< the state number far ahead, so that the real messages look old
        flooding,          ///< the current message at a high rate
        grayhole,          ///< drops a share of the real messages (man in the middle)
        simulation,        ///< the current message with the simulation bit
        stretch,           ///< the current message with a time to live of a minute (man in the middle)
    };
    Kind kind{Kind::masquerade_trip};
    double interval_ms{1};
    double drop_percent{100};
    std::uint32_t jump{10'000};
    std::optional<bool> said; ///< begins within the window when the real publisher says this
};

/// Forges GOOSE messages from the real ones that it hears. Pure; no allocation after construction.
class GooseAttack {
  public:
    /// `times`: nanoseconds; it waits also when `params.said` is given.
    GooseAttack(GooseAttackParams const& params, AttackTimes const& times, std::uint64_t seed);
    GooseAttack(GooseAttackParams const& params, std::int64_t from_ns, std::int64_t until_ns, std::uint64_t seed)
        : GooseAttack{params, AttackTimes{from_ns, until_ns}, seed} {}

    /// A real message passes. What goes on: nothing when it is dropped.
    [[nodiscard]] std::optional<GooseState> pass(std::int64_t now_ns, GooseState const& real);

    /// What it waits for has come.
    void trigger(std::int64_t now_ns) {
        if (window_.trigger(now_ns)) {
            next_ns_ = now_ns;
        }
    }

    /// The forged message that is due at `now_ns`; call again until there is none. Nothing before a real one was heard.
    [[nodiscard]] std::optional<GooseState> forge(std::int64_t now_ns);
    /// When forge() will have the next one; nothing after the end.
    [[nodiscard]] std::optional<std::int64_t> next_ns() const;

    [[nodiscard]] std::uint64_t forged() const { return forged_; }
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  private:
    [[nodiscard]] bool only_alters() const;
    [[nodiscard]] GooseState make(std::int64_t now_ns);

    GooseAttackParams params_;
    AttackWindow window_;
    std::optional<std::int64_t> next_ns_;
    Random random_;
    std::array<GooseState, 64> heard_{};
    std::size_t heard_count_{0};
    std::optional<GooseState> own_; ///< masquerade: the state that is being repeated
    std::uint64_t forged_{0}, dropped_{0};
};

} // namespace gridspace::attacker
