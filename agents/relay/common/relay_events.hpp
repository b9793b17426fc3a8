// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::relay {

/// Why the relay does not decide. A set of bits.
enum Block : std::uint32_t {
    kFilling = 1U << 0U,  ///< the window is not yet full of usable samples (start, restart, long gap)
    kFromLost = 1U << 1U, ///< no sample from that end: loss, or the partner timeout
    kToLost = 1U << 2U,
    kFromQuality = 1U << 3U, ///< invalid, questionable, not a number, or beyond 1e9 A
    kToQuality = 1U << 4U,
    kFromTest = 1U << 5U, ///< test or simulated, and the relay is not in test
    kToTest = 1U << 6U,
    kFromSynch = 1U << 7U, ///< not synchronised as required: the two ends cannot be compared
    kToSynch = 1U << 8U,
    kOutOfService = 1U << 9U, ///< switched off by its settings or an event
};
using BlockReasons = std::uint32_t;

/// "from_lost, filling"; empty for none.
[[nodiscard]] std::string block_names(BlockReasons reasons);

struct RelayEvent {
    enum class Kind : std::uint8_t {
        pickup,
        dropout,
        trip,
        withheld, ///< picked up, and the detector does not permit the trip
        released, ///< the detector permits it now
        reset,    ///< the seal was taken off
        block,
        unblock,
        window_emptied, ///< samples jumped back, or a gap longer than what is interpolated
    };
    std::int64_t index{0};
    Kind kind{Kind::pickup};
    std::uint8_t phases{0};  ///< bit 0: a, 1: b, 2: c
    BlockReasons reasons{0}; ///< block: what set it
    Abc differential_a{};
};
[[nodiscard]] std::string_view name_of(RelayEvent::Kind kind);
/// "abc" for 7.
[[nodiscard]] std::string phase_names(std::uint8_t phases);

/// Fixed memory for events between two visits of whoever writes them down. When it is full, new events are dropped and
/// counted: the first events of a disturbance are the ones that explain it.
template <class Event>
class BoundedLog {
  public:
    explicit BoundedLog(std::size_t capacity) : events_(capacity) {}

    void push(Event const& event) {
        if (count_ == events_.size()) {
            ++dropped_;
            return;
        }
        events_[count_++] = event;
    }
    /// Hands all events to `take(Event const&)`, oldest first, and forgets them.
    template <class Take>
    void drain(Take&& take) {
        for (std::size_t i = 0; i < count_; ++i) {
            take(events_[i]);
        }
        count_ = 0;
    }
    [[nodiscard]] std::size_t size() const { return count_; }
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  private:
    std::vector<Event> events_;
    std::size_t count_{0};
    std::uint64_t dropped_{0};
};
using EventLog = BoundedLog<RelayEvent>;

} // namespace gridspace::relay
