// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/arrival_statistics.hpp"
#include "gateways/iec61850/data_set.hpp"
#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/mms_data.hpp"

#include <array>
#include <optional>

namespace gridspace::iec61850 {

/// What becomes of a signal when its publisher falls silent.
struct FailSafe {
    bool force{false}; ///< false: hold the last value
    Value value{};     ///< of the leaf's type; strings are not forced
};

/// Which messages a subscriber takes. Fields that are empty are not checked; the VLAN never is (switches take tags
/// off).
struct GooseSubscription {
    std::string gocb_ref, dat_set, go_id;
    std::optional<Mac> destination, source;
    std::optional<std::uint16_t> app_id;
    std::uint32_t conf_rev{1};
    DataSet data_set;
    std::vector<FailSafe> fail_safe; ///< by leaf; fewer: the others hold
    bool simulation{false};          ///< LPHD.Sim: prefer simulated messages
    /// Replay protection: older states are refused while timeAllowedToLive runs, even from a restarted publisher; a
    /// jump of stNum by more than 1 waits for a second message.
    bool strict{false};
    std::int64_t max_skew_ns{0}; ///< strict: largest |now - t| of a new state; 0: not checked
};

enum class GooseEvent : std::uint8_t {
    not_ours, ///< another control block
    first,    ///< the first message that was taken
    state_change,
    repetition,
    resumed, ///< the first after the stream was lost
    restart, ///< stNum, or sqNum with a later t, went back: the publisher was restarted
    // refused:
    duplicate,
    out_of_order,
    stale,             ///< strict: an older state, or t too far from now
    unconfirmed_jump,  ///< strict: stNum jumped; waiting for the next message
    identity_mismatch, ///< the control block's name from another address, APPID, data set or goID
    conf_rev_mismatch,
    needs_commissioning,
    data_set_mismatch,  ///< number or types of the members
    inconsistent,       ///< other values without a new stNum
    simulation_refused, ///< simulated while it is not asked for, or real while simulated messages come
    no_time_to_live,    ///< timeAllowedToLive 0
};
inline constexpr std::size_t kGooseEvents = 17;
[[nodiscard]] std::string_view event_name(GooseEvent event) noexcept;

struct GooseVerdict {
    GooseEvent event{GooseEvent::not_ours};
    bool accepted{false};
    bool changed{false};   ///< values may differ from before
    std::uint32_t lost{0}; ///< messages of this state that did not arrive before this one
    std::uint32_t skipped_states{0};
};

enum class GooseStatus : std::uint8_t { waiting, good, expired };

/// Subscriber of one GOOSE control block. Times are nanoseconds on any one axis. Allocates nothing after construction.
class GooseSubscriber {
  public:
    struct Counters {
        std::array<std::uint64_t, kGooseEvents> events{};
        std::uint64_t lost{0}, skipped_states{0}, expired{0};
        [[nodiscard]] std::uint64_t of(GooseEvent event) const noexcept {
            return events[static_cast<std::size_t>(event)];
        }
    };

    explicit GooseSubscriber(GooseSubscription subscription);

    /// A decoded message. The frame's memory is not kept. `utc_ns` is only for max_skew_ns. `whatever_counters`: who
    /// calls knows that it is a state of its own.
    GooseVerdict receive(GooseFrame const& message, std::int64_t now_ns, std::int64_t utc_ns = 0,
                         bool whatever_counters = false) noexcept;

    /// When timeAllowedToLive runs out; nothing while nothing runs.
    [[nodiscard]] std::optional<std::int64_t> deadline() const noexcept { return deadline_ns_; }
    /// Call it when the deadline has come: true when the stream was lost just now (values are then fail-safe).
    bool expire(std::int64_t now_ns) noexcept;

    [[nodiscard]] GooseStatus status() const noexcept { return status_; }
    [[nodiscard]] std::vector<Leaf> const& leaves() const noexcept { return leaves_; }
    [[nodiscard]] std::optional<std::size_t> index_of(std::string_view leaf) const noexcept;
    /// The value to act on: the last, or after loss what fail-safe says. Before the first message zeros, or what is
    /// forced.
    [[nodiscard]] Value value(std::size_t leaf) const noexcept;

    [[nodiscard]] std::uint32_t st_num() const noexcept { return st_num_; }
    [[nodiscard]] std::uint32_t sq_num() const noexcept { return sq_num_; }
    [[nodiscard]] UtcTime t() const noexcept { return t_; }
    [[nodiscard]] Counters const& counters() const noexcept { return counters_; }
    /// Of the messages that were taken.
    [[nodiscard]] ArrivalStatistics const& arrivals() const noexcept { return arrivals_; }

    /// LPHD.Sim. Switching it off accepts real messages again.
    void set_simulation(bool simulation) noexcept;

  private:
    [[nodiscard]] std::optional<GooseEvent> reason_to_refuse(GooseFrame const& message) noexcept;
    [[nodiscard]] GooseVerdict judge_counters(GooseFrame const& message, std::int64_t utc_ns) noexcept;
    [[nodiscard]] std::uint32_t missed(std::uint32_t claimed) const noexcept;
    [[nodiscard]] GooseVerdict judge_older(GooseFrame const& message) const noexcept;
    /// Checks the members against the data set; keeps the values in `scratch_`, and in `current_` when `store`.
    enum class Match : std::uint8_t { mismatch, same, different };
    [[nodiscard]] Match match(GooseFrame const& message, bool store) noexcept;

    GooseSubscription subscription_;
    std::vector<Leaf> leaves_;
    std::vector<std::uint32_t> container_tags_; ///< of the data set depth first: a tag, or 0 for a leaf
    std::vector<std::uint8_t> depths_;
    std::vector<Value> values_;
    std::vector<std::vector<std::uint8_t>> texts_;
    GooseStatus status_{GooseStatus::waiting};
    std::optional<std::int64_t> deadline_ns_;
    std::uint32_t st_num_{0}, sq_num_{0}, live_ms_{0};
    std::optional<std::uint32_t> unconfirmed_st_num_;
    UtcTime t_;
    bool seen_simulated_{false};
    Counters counters_;
    ArrivalStatistics arrivals_;
    std::int64_t taken_{0};
};

} // namespace gridspace::iec61850
