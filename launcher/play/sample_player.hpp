// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/participant.hpp"
#include "common/idl/key.hpp"
#include "launcher/play/pace.hpp"
#include "launcher/play/play_options.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::play {

/// Writes recorded samples onto the bus: for each process that was recorded a participant of its name, so that others
/// see who wrote what. Memory is bounded by one chunk of the recording.
class SamplePlayer {
  public:
    /// Looks through the recording once; joins the bus and makes the writers.
    [[nodiscard]] static Result<std::unique_ptr<SamplePlayer>> open(std::filesystem::path const& recording,
                                                                    PlayOptions const& options);
    ~SamplePlayer();

    [[nodiscard]] std::int64_t first_ns() const { return first_ns_; } ///< of the topics that are played, since 1970
    [[nodiscard]] std::int64_t last_ns() const { return last_ns_; }
    [[nodiscard]] std::string const& note() const {
        return note_;
    } ///< why the recording is incomplete; empty when it is not
    [[nodiscard]] std::size_t topics() const;

    /// Until every topic has a reader, or the user has had enough.
    void wait_for_readers();
    /// Until nobody new has come for half a second: what is written before a reader is matched, it never hears.
    void wait_until_quiet();
    /// Plays the samples of [from, to], by the pace. What must be known before (catalogues) is written at once.
    [[nodiscard]] Result<void> play(Pace const& pace, std::int64_t from_ns, std::int64_t to_ns);
    /// Waits until readers have everything, or are gone.
    void finish();

    struct Totals {
        std::uint64_t samples{0};
        std::uint64_t refused{0}; ///< by DDS
        std::uint64_t behind{0};  ///< how often readers were waited for for more than two seconds
        std::int64_t worst_late_ns{0};
        std::map<std::string, std::uint64_t> by_topic;
    };
    [[nodiscard]] Totals const& totals() const { return totals_; }

  private:
    struct Lane;
    SamplePlayer() = default;
    [[nodiscard]] Result<void> scan(PlayOptions const& options);
    [[nodiscard]] Result<void> join(PlayOptions const& options);
    /// `in_a_hurry`: faster than it was recorded, so readers are waited for.
    void write(Lane& lane, std::span<std::byte const> cdr, bool in_a_hurry);

    /// Until its reliable readers have taken everything. One that is dead is waited for until its lease runs out.
    void wait_for_readers_of(Lane const& lane);

    std::filesystem::path recording_;
    std::int64_t first_ns_{0}, last_ns_{0};
    std::string note_;
    std::map<std::pair<std::string, std::int64_t>, std::unique_ptr<bus::Participant>>
        participants_; ///< by process and domain
    std::vector<std::unique_ptr<bus::RawWriter>> catalogues_;
    std::map<std::uint16_t, std::unique_ptr<Lane>> lanes_; ///< by channel of the recording
    Totals totals_;
};

} // namespace gridspace::play
