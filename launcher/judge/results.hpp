// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/folder/event_log.hpp"
#include "launcher/folder/machine_latency.hpp"
#include "launcher/folder/run_outcome.hpp"
#include "launcher/judge/consequences.hpp"
#include "launcher/judge/counters.hpp"
#include "launcher/judge/expectation.hpp"
#include "launcher/judge/intrusion_score.hpp"
#include "launcher/judge/process_ends.hpp"
#include "launcher/wire/capture_statistics.hpp"
#include "recorder/signals/signal_store.hpp"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// A finished run as it lies on disk, judged by its expectations.
struct Results {
    std::filesystem::path folder;
    std::string scenario, description, mode;
    double duration_s{0};
    std::int64_t epoch_unix_s{0};
    RunOutcome outcome;
    std::vector<ExpectationResult> expectations;
    struct Topic {
        std::string topic, type;
        std::uint64_t samples{0};
        std::vector<std::string> processes;
    };
    std::vector<Topic> topics;
    std::vector<LoggedEvent> events;
    Moments moments; ///< of the timeline, and of what processes reported
    struct ProcessRow {
        std::string name, program, host, end;
        int code{0};
        double cpu_s{0}; ///< user and system time
    };
    std::vector<ProcessRow> processes;
    std::string recording_note;     ///< when the recording is not complete
    std::optional<double> cut_at_s; ///< the newest that is in a recording which was cut
    bool unjudged{false};           ///< the expectations cannot be read; the last note says why
    SignalStore signals;            ///< all that were recorded, and what follows from them
    /// Of these only the last value is in `signals`: an hour of all does not fit into memory (run_signals.hpp).
    std::set<std::string> last_values;
    Silences silences;        ///< where signals have no value, because their process was killed
    CounterGaps counter_gaps; ///< what counters of processes that were killed or started again do not hold
    /// What the capture of the run says, read where a declared stream has no counters of its own or these have a gap.
    std::optional<wire::CaptureStatistics> capture;
    IntrusionScore intrusion;                      ///< of detectors and attacks, where there were some
    std::optional<Consequences> consequences;      ///< of attacks
    std::string scheduling;                        ///< of the processes, in real time
    std::string idle_processors;                   ///< "awake", or why they may sleep
    std::optional<MachineLatency> machine_latency; ///< as the user has measured it, in real time
    std::vector<std::string> comtrade;             ///< disturbance records in RUN/comtrade
    std::vector<std::string> notes;                ///< what the user should know

    [[nodiscard]] bool passed() const; ///< no expectation failed that is not advisory
    /// The exit code of `gridspace run`: that of the run, or 1 when an expectation failed.
    [[nodiscard]] int exit_code() const;
};

/// Text that names signals which somebody wants whole, beside those that a resolved scenario names.
using AlsoNamed = std::string_view (*)(config::Node const& scenario);

/// Reads a run folder: manifest, resolved scenario, recording, events; judges the expectations. `seen` is the outcome
/// for who has seen the run: a full disk may have kept it from the manifest.
[[nodiscard]] Result<Results> read_results(std::filesystem::path const& folder, RunOutcome const* seen = nullptr,
                                           AlsoNamed also_named = nullptr);

} // namespace gridspace::launcher
