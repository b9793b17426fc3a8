// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/recording_loss.hpp"
#include "launcher/judge/standing.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/signal_store.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace gridspace::launcher {

/// What a run is to do, for who judges it while it goes on.
struct JudgedRun {
    std::filesystem::path folder; ///< with the recording and the events as they grow
    std::vector<Expectation> expectations;
    config::Node timeline; ///< `events:` of the scenario
    double duration_s{0};
    std::int64_t epoch_unix_s{0};
    bool lockstep{true};
};

/// Judges the expectations of a run by its recording so far. Memory holds the signals that they use.
class LiveJudge {
  public:
    explicit LiveJudge(JudgedRun run);

    struct Look {
        double reached_s{0}; ///< what is said is said by all that was recorded up to here
        std::vector<ExpectationStanding> standings;
    };
    /// Reads on, and judges by all up to where the recording had come when it was looked at before: what is younger may
    /// not be complete. Nothing when that is no further than last time.
    [[nodiscard]] std::optional<Look> look();

  private:
    [[nodiscard]] bool wanted(std::string const& signal) const;
    void read_on();
    [[nodiscard]] SignalStore signals_until(std::int64_t until_ns);

    JudgedRun run_;
    mcap::GrowingFile recording_;
    SignalReader signals_;
    RecordingLoss published_;
    std::int64_t now_ns_{-1}, before_ns_{-1}; ///< how far the recording has come, and had come at the look before
    std::int64_t judged_ns_{-1};
};

} // namespace gridspace::launcher
