// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "ids/scoring/scorer.hpp"
#include "launcher/folder/event_log.hpp"
#include "launcher/judge/intrusion_recording.hpp"
#include "recorder/signals/signal_store.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Detectors against the truth of a run: verdicts joined with labels, and trips with the faults that really were.
struct IntrusionScore {
    IntrusionRecording recording;
    struct Stream { ///< what one detector said about one stream
        std::string detector, stream;
        ids::Score score;        ///< phase-samples
        ids::Share packets;      ///< samples (three phases) with a false positive
        ids::Share open_packets; ///< the same of the open loop
    };
    std::vector<Stream> streams;
    struct Attack { ///< one attack as one detector saw it
        std::string detector, kind, target;
        double rate_hz{0};
        ids::AttackScore score;
    };
    std::vector<Attack> attacks;
    struct Unjudged {
        std::string attack, kind, target;
        std::uint64_t labels{0};
    };
    std::vector<Unjudged> unjudged; ///< attacks on what no detector watches

    struct Relay {           ///< of a line
        bool watched{false}; ///< it has a detector
        std::string relay, from_stream, to_stream, line;
        double rate_hz{0};
        std::vector<double> faults_s; ///< on its line
        std::vector<std::int64_t> trips,
            trips_without;           ///< sample indices: as it was, and of the same relay on the raw samples
        std::vector<double> trips_s; ///< when it gave them
        ids::TripScore with, without;
        std::optional<double> added_ms;    ///< longest, of the faults on which both tripped; nothing when there is none
        std::vector<double> added_each_ms; ///< of each such fault
        std::uint64_t alarms{0}, false_alarms{0}; ///< false: nothing was forged on its streams within 5 ms before
    };
    std::vector<Relay> relays;
};

struct ScoredNetwork {
    config::Node file; ///< as it was run (network_of_run)
    double frequency_hz{60};
};

/// `scenario`: resolved.
[[nodiscard]] IntrusionScore score_intrusion(IntrusionRecording recording, config::Node const& scenario,
                                             ScoredNetwork const& network, SignalStore const& signals,
                                             std::vector<LoggedEvent> const& events, double end_s);

/// Adds it as signals with one value, at the end of the run: ids.<detector>.<stream>.false_positive_percent …,
/// score.<attack>.detected_percent …, ids.<relay>.false_trips …
void add_intrusion_signals(IntrusionScore const& score, double end_s, SignalStore& signals);

/// Reads and scores the run of a folder; empty when nothing watched or attacked.
[[nodiscard]] Result<IntrusionScore> read_intrusion_score(std::filesystem::path const& folder,
                                                          SignalStore const& signals,
                                                          std::vector<LoggedEvent> const& events, double end_s);

} // namespace gridspace::launcher
