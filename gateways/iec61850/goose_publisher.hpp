// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose_template.hpp"

#include <optional>

namespace gridspace::iec61850 {

/// When a state is repeated: at once, after min, then after intervals that grow by `growth`, up to max for ever.
struct GooseTiming {
    std::int64_t min_ns{2'000'000}, max_ns{1'000'000'000};
    double growth{2};
    double live_factor{3};        ///< timeAllowedToLive is this times the next interval; at least 2 is usual
    std::uint32_t live_min_ms{0}; ///< and never below this
};

struct GoosePublisherParams {
    GooseTiming timing;
    std::uint32_t first_sq_num{0}; ///< of the very first message; Edition 1 conformance tests want 1
    std::uint32_t first_st_num{1}; ///< other than 1 when a running publisher is configured anew
    bool simulation{false};
    std::uint8_t time_quality{0x0A};
};

/// Publisher of one GOOSE control block (IEC 61850-8-1, 18.1): decides what is sent and when. Times are nanoseconds on
/// any one axis (monotonic, or simulated); the time of day is only for the stamp t. Allocates nothing after
/// construction.
class GoosePublisher {
  public:
    struct Counters {
        std::uint64_t sent{0}, states{0};
        std::uint64_t late{0};    ///< messages after the next one was due already
        std::uint64_t refused{0}; ///< values that the leaf cannot hold
    };

    GoosePublisher(GooseTemplate frame, std::uint32_t conf_rev, GoosePublisherParams const& params);

    /// Initial values are those set() before. The first message is due at once.
    void start(std::int64_t now_ns, std::int64_t utc_ns);

    /// Stages a value; commit() makes one new state of all that was staged and now differs from the state before: what
    /// has come back to its old value in between was no change. Timestamps alone make none (they are sent
    /// with the next state or repetition), because a device stamps with every scan.
    GooseTemplate::Stored set(std::size_t leaf, Value const& value) noexcept;
    /// True when a new state began: its first message is due at `now_ns`, whatever was scheduled.
    bool commit(std::int64_t now_ns, std::int64_t utc_ns) noexcept;

    /// When the next message is due; nothing before start().
    [[nodiscard]] std::optional<std::int64_t> due() const noexcept { return due_ns_; }
    /// The message that is due, or nothing. Valid until the next call.
    [[nodiscard]] Octets take(std::int64_t now_ns) noexcept;
    /// The state once more, now, whatever is due: the last word of a publisher that stops.
    [[nodiscard]] Octets last(std::int64_t now_ns) noexcept;

    [[nodiscard]] GooseState const& state() const noexcept { return state_; }
    [[nodiscard]] Counters const& counters() const noexcept { return counters_; }
    [[nodiscard]] GooseTemplate& frame() noexcept { return frame_; }
    [[nodiscard]] std::int64_t interval_ns() const noexcept { return interval_ns_; } ///< to the message after the next
    void set_simulation(bool simulation) noexcept { state_.simulation = simulation; }

  private:
    [[nodiscard]] Octets emit() noexcept;
    [[nodiscard]] std::uint32_t live_ms() const noexcept;
    /// The values become those of the state; true when one differs.
    bool keep_values() noexcept;
    void begin_state(std::int64_t now_ns, std::int64_t utc_ns) noexcept;

    /// A value of the state; of a string its octets.
    struct Kept {
        std::uint64_t bits{0};
        std::string text{};
    };

    GooseTemplate frame_;
    GoosePublisherParams params_;
    std::vector<Kept> kept_; ///< by leaf; timestamps are not in it
    GooseState state_;
    std::optional<std::int64_t> due_ns_;
    std::int64_t interval_ns_{0};
    bool staged_{false}, first_of_state_{true};
    Counters counters_;
};

} // namespace gridspace::iec61850
