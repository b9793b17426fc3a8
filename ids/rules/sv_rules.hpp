// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace gridspace::ids {

/// What the first line of defence looks at in a frame of sampled values, before any model. Filled from the decoder.
struct SvFacts {
    std::array<std::uint8_t, 6> source{};
    std::uint16_t app_id{0}, vlan{0};
    std::uint64_t sv_id_hash{0}; ///< of svID and data set name, any stable hash
    std::uint32_t conf_rev{1};
    std::uint16_t smp_cnt{0};
    std::uint8_t smp_synch{2};
    bool simulated{false};
    bool behind_another{false}; ///< not the first sample of its frame
    std::int64_t arrival_ns{0};
};

/// Why a frame is suspicious. A set of bits.
enum SvFinding : std::uint32_t {
    kWrongSource = 1U << 0U,   ///< another source address than the bound one
    kWrongIdentity = 1U << 1U, ///< APPID, VLAN, svID or confRev
    kDuplicate = 1U << 2U,     ///< a sample that was there already
    kOutOfOrder = 1U << 3U,    ///< older than the last one, and not there yet
    kGap = 1U << 4U,           ///< samples are missing before it; the frame itself is good
    kSimulatedFrame = 1U << 5U,
    kUnsynchronised = 1U << 6U, ///< smpSynch fell
    kBadArrival = 1U << 7U, ///< outside the usual interval: median + 6 MAD of 64 recent ones, at least half an interval
    kBadCounter = 1U << 8U, ///< smpCnt beyond the rate
};
inline constexpr std::size_t kSvFindings = 9;
[[nodiscard]] std::string sv_finding_names(std::uint32_t findings);

struct SvRuleParams {
    std::uint32_t rate_hz{4800};
    bool test_mode{false};
    bool check_arrival{true};   ///< switch off in lockstep, where arrival says nothing
    int resynchronise_after{3}; ///< consistent frames out of order that make a new sequence
};

/// First-line rules of one subscribed stream. The first good frame binds source address and identity. O(1), no
/// allocation.
class SvRules {
  public:
    explicit SvRules(SvRuleParams const& params) : params_{params} {}

    struct Verdict {
        bool accept{true};
        std::uint32_t findings{0};
        std::uint32_t missing{0};   ///< samples before this one
        bool resynchronised{false}; ///< a new sequence begins with this frame: restart what depends on the old one
    };
    Verdict judge(SvFacts const& f);
    /// Forgets the sequence, not the binding.
    void restart() { running_ = false; }
    /// Forgets both: an engineer has changed the publisher.
    void unbind() { *this = SvRules{params_}; }

    [[nodiscard]] std::array<std::uint64_t, kSvFindings> const& counters() const {
        return counters_;
    } ///< by bit of SvFinding

  private:
    [[nodiscard]] std::uint32_t strange(SvFacts const& f) const; ///< findings for which it is not the stream's frame
    void follow(SvFacts const& f, Verdict& out);                 ///< a frame of the stream
    void find_place(std::uint16_t smp_cnt, Verdict& out);        ///< among those that came before
    [[nodiscard]] bool late_or_early(std::int64_t interval_ns);

    SvRuleParams params_;
    bool bound_{false}, running_{false};
    SvFacts identity_;
    std::uint16_t last_{0};
    std::uint16_t other_next_{0}; ///< a sequence other than the accepted one
    int other_run_{0};            ///< frames of it
    std::uint64_t seen_{0};       ///< bit k: sample last_ - k came
    std::int64_t last_arrival_ns_{0};
    std::array<std::int64_t, 64> intervals_{};
    std::size_t interval_count_{0};
    std::int64_t usual_ns_{0}, allowed_ns_{0}; ///< interval, and how far from it is not odd
    std::array<std::uint64_t, kSvFindings> counters_{};
};

} // namespace gridspace::ids
