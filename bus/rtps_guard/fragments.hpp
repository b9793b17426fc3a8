// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

#include <compare>
#include <cstdint>
#include <list>
#include <map>
#include <vector>

namespace gridspace::rtps_guard {

/// Samples that come in fragments are put together here: Fast DDS 2.9 never sees a DATA_FRAG, and what a later fragment
/// says otherwise than an earlier one, or a whole sample than its own fragments, cannot end it. What waits is counted
/// for the participant that sends the datagram, not for the one in whose name a submessage says that it speaks
/// (INFO_SRC), who may be anybody. Pure: the caller has the clock.
class Fragments {
  public:
    static constexpr std::size_t kMaxOctets = 128U << 20U;     ///< of all samples that wait for fragments
    static constexpr std::size_t kMaxOctetsOfOne = 32U << 20U; ///< of those of one participant
    static constexpr std::size_t kMaxSamples = 512;
    static constexpr std::size_t kMaxSamplesOfOne = 64;
    static constexpr std::int64_t kForgottenAfterNs = 10'000'000'000; ///< without a new fragment

    /// The messages that a datagram with fragments, which examine() has admitted, comes to, in their order: what stands
    /// between its fragments, and each sample that is whole now, as DATA in a message of its own.
    [[nodiscard]] std::vector<std::vector<std::uint8_t>> take(std::span<std::uint8_t> datagram, std::int64_t now_ns);

    [[nodiscard]] std::size_t samples() const { return waiting_.size(); }
    [[nodiscard]] std::size_t octets() const { return octets_; }

  private:
    struct Name {
        GuidPrefix source{};
        EntityId reader{0}, writer{0};
        std::int64_t sequence{0};
        friend auto operator<=>(Name const&, Name const&) = default;
    };
    struct Sample {
        Name name;
        GuidPrefix sender{};       ///< of the datagram with the first fragment
        std::uint32_t fragment{0}; ///< octets of each but the last
        std::uint32_t missing{0};  ///< fragments
        std::vector<bool> here;
        std::vector<std::uint8_t> octets, qos; ///< the inline QoS of the first fragment
        bool little{true};                     ///< how that is written
        std::int64_t heard_ns{0};
    };
    using Samples = std::list<Sample>;

    struct Held {
        std::size_t samples{0}, octets{0};
    };

    /// Adds what a DATA_FRAG brings; its sample when that is whole, which is then not kept any longer.
    Samples take(GuidPrefix const& sender, GuidPrefix const& source, std::uint8_t flags, Octets body,
                 std::int64_t now_ns);
    /// Its sample as a DATA submessage, the last one of a message.
    static void put_data(std::vector<std::uint8_t>& message, Sample const& whole);
    void make_room(GuidPrefix const& sender, std::size_t octets);
    void forget_silent(std::int64_t now_ns);
    void forget(Samples::iterator sample);
    void account(Sample const& sample, bool more);

    Samples waiting_;                 ///< the oldest first
    std::map<GuidPrefix, Held> held_; ///< by sender
    std::size_t octets_{0};
    std::int64_t looked_ns_{INT64_MIN}; ///< when the silent ones were looked for
};

} // namespace gridspace::rtps_guard
