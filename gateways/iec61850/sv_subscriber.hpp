// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/arrival_statistics.hpp"
#include "gateways/iec61850/sv.hpp"

#include <optional>
#include <string>

namespace gridspace::iec61850 {

/// What a subscriber expects of one svID, and how it judges its counter.
struct SvSubscription {
    std::string sv_id;
    std::optional<Mac> destination, source;
    std::optional<std::uint16_t> app_id;
    std::uint32_t conf_rev{1};
    std::size_t sample_octets{0}; ///< 0: not checked
    bool simulation{false};       ///< LPHD.Sim: prefer simulated frames; real ones count until the first of those
    double rate_hz{4800};         ///< for silence, and for gaps longer than half of a wrap
    std::uint32_t wrap{4800};     ///< 0: not known, learned as the rate is when smpCnt comes back to 0 or out of a gap
    std::uint32_t late_window{
        16}; ///< a counter at most so far behind is a late sample or a copy, farther: a restart; at most 63
    /// More samples than this missing: a restart of the stream, not a loss. Of a stream with an unknown wrap, time says
    /// which of the two it is as soon as its rate was seen.
    std::uint32_t max_gap{4800};
    double silence_periods{8}; ///< no sample for so long: the stream is lost
};

enum class SvEvent : std::uint8_t {
    first,
    in_order,
    lost,        ///< taken; `lost` samples are missing before it
    restart,     ///< taken; the counter jumped
    duplicate,   ///< not taken: it was there already
    late,        ///< not taken: newer ones were there first, and this one not yet; it no longer counts as lost
    unconfirmed, ///< not taken: the counter jumped, and the next sample has to say so too
    identity_mismatch,
    conf_rev_mismatch,
    size_mismatch,
    simulation_refused, // not taken: simulated and not asked for, or real while simulated frames come
};
inline constexpr std::size_t kSvEvents = 11;
[[nodiscard]] std::string_view event_name(SvEvent event) noexcept;

struct SvArrival {
    SvEvent event{SvEvent::first};
    bool accepted{false};
    std::uint32_t lost{0};
    /// Counts samples without wrapping; congruent to smpCnt modulo the wrap. A late sample has the index of its place.
    std::int64_t index{0};
};

/// Supervision of one SV stream by its counter and its arrival times (nanoseconds on any one axis). Allocates nothing.
///
/// A counter that jumps, farther than time explains, is believed when the next frame goes on from there. So a frame
/// that somebody forged or that was damaged moves nothing, of however many samples it is, and a publisher that begins
/// anew is followed one frame later.
class SvSubscriber {
  public:
    struct Counters {
        std::array<std::uint64_t, kSvEvents> events{};
        std::uint64_t samples{0}, lost{0}, silences{0}; ///< lost: missing now; it sinks when a late one comes
        [[nodiscard]] std::uint64_t of(SvEvent event) const noexcept { return events[static_cast<std::size_t>(event)]; }
    };

    explicit SvSubscriber(SvSubscription subscription);

    [[nodiscard]] bool is_mine(Asdu const& asdu) const noexcept { return asdu.sv_id == subscription_.sv_id; }
    /// Whether a frame has the addresses and the APPID of this stream. The VLAN is not looked at.
    [[nodiscard]] bool is_addressed(FrameHeader const& header) const noexcept;
    /// An ASDU of this svID.
    SvArrival receive(FrameHeader const& header, Asdu const& asdu, std::int64_t now_ns) noexcept;
    /// The counter alone.
    SvArrival receive(std::uint16_t smp_cnt, std::int64_t now_ns) noexcept;

    /// When the stream counts as silent unless something comes; nothing before the first sample and while it is silent.
    [[nodiscard]] std::optional<std::int64_t> deadline() const noexcept;
    /// Call it when the deadline has come: true when the stream fell silent just now.
    bool expire(std::int64_t now_ns) noexcept;
    [[nodiscard]] bool alive() const noexcept { return started_ && !silent_; }

    /// What is missing and can no longer come late. Never sinks.
    [[nodiscard]] std::uint64_t lost_for_good() const noexcept;

    [[nodiscard]] std::uint32_t wrap() const noexcept { return wrap_; } ///< 65536 until it is known
    [[nodiscard]] bool wrap_known() const noexcept { return wrap_known_; }
    [[nodiscard]] std::uint8_t smp_synch() const noexcept { return smp_synch_; }
    [[nodiscard]] std::int64_t last_index() const noexcept { return index_; }
    [[nodiscard]] Counters const& counters() const noexcept { return counters_; }
    [[nodiscard]] ArrivalStatistics const& arrivals() const noexcept { return arrivals_; }
    [[nodiscard]] SvSubscription const& subscription() const noexcept { return subscription_; }

  private:
    [[nodiscard]] bool rate_seen() const noexcept;
    [[nodiscard]] double rate_hz() const noexcept;
    [[nodiscard]] double periods_until(std::int64_t now_ns) const noexcept;
    [[nodiscard]] std::int64_t index_of(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept;
    void learn_wrap(std::uint16_t smp_cnt, std::int64_t now_ns) noexcept;
    [[nodiscard]] std::uint32_t wrap_over_gap(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept;
    [[nodiscard]] bool time_explains(std::int64_t step, std::int64_t now_ns) const noexcept;
    [[nodiscard]] bool is_jump(std::uint16_t smp_cnt, std::int64_t now_ns) const noexcept;
    [[nodiscard]] bool is_loss(std::int64_t step, std::int64_t now_ns) const noexcept;
    [[nodiscard]] bool goes_on_from_jump(std::uint16_t smp_cnt) const noexcept;
    [[nodiscard]] std::uint32_t refused_before(bool confirmed, std::int64_t step) const noexcept;
    SvArrival count(SvArrival arrival) noexcept;
    void move_on(SvArrival const& arrival, bool one_was_refused) noexcept;
    SvArrival behind(std::int64_t index) noexcept;

    SvSubscription subscription_;
    std::uint32_t wrap_;
    bool wrap_known_;
    bool started_{false}, silent_{false}, seen_simulated_{false};
    std::uint32_t run_{0}; ///< consecutive samples in order
    std::uint16_t last_cnt_{0};
    std::optional<std::uint16_t> jumped_to_; ///< of a sample that waits for the next frame
    std::int64_t jumped_at_ns_{0};           ///< arrival of its frame
    std::uint32_t jump_refused_{0};          ///< samples that wait so, one after the other
    std::uint8_t smp_synch_{0};
    std::int64_t index_{0}, last_ns_{0};
    std::uint64_t seen_{0}, missing_{0}; ///< bit k: sample index_ - k came; counts as lost and may still come
    Counters counters_;
    ArrivalStatistics arrivals_;
};

} // namespace gridspace::iec61850
