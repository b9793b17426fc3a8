// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/relay_events.hpp"
#include "agents/relay/differential_element.hpp"

namespace gridspace::relay {

/// The direction in which a CT counts current as positive. `from_to`: along the line, from its `from` end to its `to`
/// end, so that both ends of a healthy line read the same.
enum class Positive { from_to, into_line };

struct RelayParams {
    ElementParams element;
    Positive from_positive{Positive::from_to};
    Positive to_positive{Positive::from_to};
    int confirm_samples{1};  ///< consecutive samples above pickup before the trip; 1 as published
    bool seal_in{true};      ///< the trip stays until reset(); false: it falls with the pickup
    int max_interpolated{3}; ///< samples missing in a row that are bridged by a straight line; more empty the window
    bool accept_questionable{false};
    Synch required_synch{Synch::global}; ///< the least that is accepted
    bool test_mode{false};               ///< accept samples marked test or simulated
    bool in_service{true};
    std::size_t event_capacity{256};
};

/// A detector's say in the decision. The default permits.
struct TripPermission {
    bool granted{true};
};

/// Whether the relay would decide by this sample: present, of good quality, synchronised, not for a test.
[[nodiscard]] bool usable(EndSample const& sample, RelayParams const& params);

struct RelayOutput {
    std::int64_t index{0};
    bool evaluated{false};   ///< the window was full and nothing blocked: `values` belong to this index
    bool pickup{false};      ///< holds over a gap that can still be bridged, as the trip does
    bool trip{false};        ///< what the trip contact says
    bool withheld{false};    ///< picked up and confirmed, and not permitted
    BlockReasons blocked{0}; ///< 0: in operation
    ElementValues values;
};

struct RelayCounters {
    std::uint64_t samples{0}; ///< pairs taken
    std::uint64_t from_missing{0}, to_missing{0}, unusable{0};
    std::uint64_t interpolated{0}; ///< pairs bridged
    std::uint64_t stale{0};        ///< pairs with an index that was already taken; ignored
    std::uint64_t windows_emptied{0};
    std::uint64_t pickups{0}, trips{0};
};

/// Line differential relay: two ends of a line in, a trip out. No clock, no I/O, no allocation per sample.
///
/// Nothing is decided by a sample that is missing or unusable. When no more than `max_interpolated` are missing in a
/// row, pickup, confirmation and trip stay as they are, `blocked` says so, and the gap is bridged as soon as the next
/// usable pair arrives; only pairs that came count as confirmation, so that no trip rests on bridged samples alone.
/// Otherwise the pickup drops out and the relay blocks until a whole window of usable samples has passed.
/// Unsynchronised and test samples always empty the window. Where nothing comes any more, time has to say so: lost().
class LineRelay {
  public:
    explicit LineRelay(RelayParams const& params);

    /// Takes the pair of one instant. Indices rise by one; a jump forward counts as missing pairs, an index that is not
    /// newer is ignored. The reference holds until the next call.
    RelayOutput const& step(LineSample const& sample, TripPermission permission = {});

    /// Nothing came of these ends (kFromLost, kToLost) for longer than a sample waits for its partner, so that there is
    /// no pair to say it: blocked until pairs come again. What the window holds is judged then, by the length of the
    /// gap.
    RelayOutput const& lost(BlockReasons ends);

    /// Takes the seal off. False, and nothing happens, while the element still picks up.
    bool reset();
    /// Forgets the samples (a stream was restarted); the seal stays.
    void restart();
    void set_in_service(bool in_service) { params_.in_service = in_service; }

    [[nodiscard]] RelayOutput const& output() const { return output_; }
    [[nodiscard]] RelayCounters const& counters() const { return counters_; }
    [[nodiscard]] RelayParams const& params() const { return params_; }
    [[nodiscard]] EventLog& events() { return events_; }

  private:
    struct Pair {
        Abc from{}, to{};
    };
    [[nodiscard]] BlockReasons unusable(LineSample const& sample);
    [[nodiscard]] Pair into_line(LineSample const& sample) const;
    void bridge(Pair const& next, std::int64_t missing);
    void empty_window(std::int64_t index);
    void decide(std::int64_t index, TripPermission permission);
    void set_blocked(std::int64_t index, BlockReasons reasons);
    void note(std::int64_t index, RelayEvent::Kind kind, BlockReasons reasons = 0);

    RelayParams params_;
    DifferentialElement element_;
    EventLog events_;
    RelayOutput output_;
    RelayCounters counters_;
    BlockReasons said_{0}; ///< what events have told about the present block
    Pair last_good_;
    std::int64_t last_index_{0}, last_good_index_{0};
    bool started_{false}, has_good_{false};
    int confirmed_{0};
};

} // namespace gridspace::relay
