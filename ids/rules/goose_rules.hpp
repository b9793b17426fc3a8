// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace gridspace::ids {

/// What the first line of defence looks at in a GOOSE message.
struct GooseFacts {
    std::array<std::uint8_t, 6> source{};
    std::uint16_t app_id{0}, vlan{0};
    std::uint64_t identity_hash{0}; ///< of gocbRef, datSet and goID
    std::uint32_t conf_rev{1}, entries{1};
    std::uint32_t st_num{1}, sq_num{0}, live_ms{0};
    std::int64_t t_ns{0}; ///< of the last change of state
    bool simulated{false}, needs_commissioning{false};
    std::uint64_t value_hash{0}; ///< of the data set's values
    std::int64_t arrival_ns{0};
};

/// Why a message is suspicious. A set of bits.
enum GooseFinding : std::uint32_t {
    kGooseWrongSource = 1U << 0U,
    kGooseWrongIdentity = 1U << 1U,
    kGooseOld = 1U << 2U,     ///< (stNum, sqNum) not newer than the last: replay
    kGooseJump = 1U << 3U,    ///< stNum rose by more than one; held until the source's next message confirms it
    kGooseOldTime = 1U << 4U, ///< a new state with an older time
    kGooseClock = 1U << 5U,   ///< the time of a new state is more than 2 s from the arrival
    kGooseSimulated = 1U << 6U,
    kGooseCommissioning = 1U << 7U,
    kGooseFlood = 1U << 8U,         ///< more messages than the retransmission allows
    kGooseStretched = 1U << 9U,     ///< time to live above three times the longest that is usual
    kGooseSilentChange = 1U << 10U, ///< values changed and stNum did not
    kGooseContest = 1U << 11U,      ///< two publishers with one address: each goes on where the other is not
};
inline constexpr std::size_t kGooseFindings = 12;
[[nodiscard]] std::string goose_finding_names(std::uint32_t findings);

struct GooseRuleParams {
    double min_time_ms{1}, max_time_ms{1000}; ///< of the retransmission
    double longest_live_ms{
        0}; ///< time to live in steady state; short at first, it grows with the intervals. 0: as the first message says
    bool test_mode{false};
    bool check_clock{true}; ///< needs synchronised clocks
    int burst{16};          ///< messages that may come at once
    bool accept_in_contest{true};
};

/// First-line rules of one subscribed GOOSE stream. No single message ever sets the high-water mark of stNum: a jump is
/// believed when the next message of the same source goes on from it. O(1), no allocation.
///
/// Who writes the publisher's address and its next stNum makes every later message of the real publisher look old. But
/// the real one goes on: with the state that was ended for it, or with a state of its own. That is a contest, and no
/// rule can say who is real. While it lasts each state that has not been seen before is accepted, whoever begins it (of
/// two who disagree, the one that asks for a trip is heard), or none is: `accept_in_contest`.
class GooseRules {
  public:
    explicit GooseRules(GooseRuleParams const& params) : params_{params}, tokens_{static_cast<double>(params.burst)} {}

    struct Verdict {
        bool accept{true};
        bool contested{false}; ///< accepted as a new state although its counters are not next
        std::uint32_t findings{0};
    };
    Verdict judge(GooseFacts const& f);
    /// The time to live has run out: the publisher may have been restarted, and starts again at state 1.
    void expired() { running_ = false; }

    [[nodiscard]] std::array<std::uint64_t, kGooseFindings> const& counters() const { return counters_; }

  private:
    /// A state of the data set of a publisher, with its newest message.
    struct State {
        std::uint32_t st_num{0}, sq_num{0}, live_ms{0};
        std::int64_t t_ns{0}, arrival_ns{0};
        std::uint64_t value_hash{0}, order{0}; ///< order: of the first message
        [[nodiscard]] bool is_of(GooseFacts const& f) const {
            return st_num == f.st_num && t_ns == f.t_ns && value_hash == f.value_hash;
        }
        [[nodiscard]] bool precedes(GooseFacts const& f) const; ///< `f` is its next message, or of the state after it
        [[nodiscard]] bool runs_at(std::int64_t now_ns) const {
            return now_ns - arrival_ns <= std::int64_t{live_ms} * 1'000'000;
        }
    };
    static State state_of(GooseFacts const& f);
    [[nodiscard]] bool flooded(std::int64_t now_ns);
    [[nodiscard]] std::uint32_t judge_counters(GooseFacts const& f, bool& begins);
    /// `f` begins a state, which is the current one now.
    void enter(GooseFacts const& f);

    GooseRuleParams params_;
    bool bound_{false}, running_{false};
    GooseFacts identity_;
    std::array<State, 8> known_{}; ///< what has been accepted, the real publisher's running state among it
    std::size_t known_count_{0}, current_{0};
    std::uint64_t order_{0};
    State jump_, rival_; ///< seen once: a stNum too high, one too low; each waits for its confirmation
    bool has_jump_{false}, has_rival_{false};
    std::int64_t contested_until_ns_{INT64_MIN};
    double tokens_;
    std::int64_t last_token_ns_{0};
    bool counted_{false};
    std::array<std::uint64_t, kGooseFindings> counters_{};
};

} // namespace gridspace::ids
