// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/interrupt_watch.hpp"
#include "launcher/sweep/result_table.hpp"

#include <functional>
#include <string_view>

namespace gridspace::launcher {

struct SweepOptions {
    std::filesystem::path out; ///< the study's folder
    std::size_t jobs{1};       ///< at once; of Slurm's tasks, 0: as many as it likes
    bool slurm{false};         ///< as job arrays instead of processes of this machine
    bool keep{false};          ///< run folders of runs that passed, too
    bool resume{false};        ///< an error where nothing was begun
};

struct SweepProgress {
    std::size_t done{0}, of{0};   ///< runs that are to be done now
    std::size_t failed{0};        ///< of these, with an expectation that failed or an early end
    std::optional<double> left_s; ///< known after the first run
};

/// What is said while it goes on.
struct SweepListener {
    std::function<void(SweepProgress const&, bool last)> progress;
    std::function<void(std::string_view)> note;
};

struct FinishedSweep {
    StudyFolder folder;
    std::vector<std::optional<RunRecord>> records; ///< by run; none: not done
    std::size_t found{0};                          ///< runs that were there already
    double wall_s{0};
    bool is_interrupted{false};
    std::optional<Error> stopped; ///< why it went no further: nothing more would have succeeded

    [[nodiscard]] std::size_t count(std::string_view state) const; ///< "passed", "failed", "ended_early", "open"
    [[nodiscard]] int exit_code() const;
};

/// The records of a study that are there already, by run.
[[nodiscard]] std::vector<std::optional<RunRecord>> read_records(StudyPlan const& plan, StudyFolder const& folder);

/// Does the runs of a study that are not there yet, `jobs` at a time, and writes the table. A run is written down
/// before anything of it is thrown away, so that whoever is killed at any moment loses only what was under way. Fails
/// when it cannot begin: the folder cannot be written, somebody else works in it.
[[nodiscard]] Result<FinishedSweep> sweep(Study const& study, StudyPlan const& plan, SweepOptions const& options,
                                          SweepListener const& listener, InterruptWatch& interrupts);

} // namespace gridspace::launcher
