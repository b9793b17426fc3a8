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
};
inline constexpr std::size_t kGooseFindings = 11;
[[nodiscard]] std::string goose_finding_names(std::uint32_t findings);

struct GooseRuleParams {
    double min_time_ms{1}, max_time_ms{1000}; ///< of the retransmission
    double longest_live_ms{
        0}; ///< time to live in steady state; short at first, it grows with the intervals. 0: as the first message says
    bool test_mode{false};
    bool check_clock{true}; ///< needs synchronised clocks
    int burst{16};          ///< messages that may come at once
};

/// First-line rules of one subscribed GOOSE stream. No single message ever sets the high-water mark of stNum: a jump is
/// believed when the next message of the same source goes on from it. O(1), no allocation.
class GooseRules {
  public:
    explicit GooseRules(GooseRuleParams const& params) : params_{params}, tokens_{static_cast<double>(params.burst)} {}

    struct Verdict {
        bool accept{true};
        std::uint32_t findings{0};
    };
    Verdict judge(GooseFacts const& f);
    /// The time to live has run out: the publisher may have been restarted, and starts again at state 1.
    void expired() { running_ = false; }

    [[nodiscard]] std::array<std::uint64_t, kGooseFindings> const& counters() const { return counters_; }

  private:
    [[nodiscard]] bool flooded(std::int64_t now_ns);

    GooseRuleParams params_;
    bool bound_{false}, running_{false}, held_{false};
    GooseFacts identity_, last_, candidate_; ///< candidate: a jump that waits for its confirmation
    double tokens_;
    std::int64_t last_token_ns_{0};
    bool counted_{false};
    std::array<std::uint64_t, kGooseFindings> counters_{};
};

} // namespace gridspace::ids
