// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/run/interrupt_watch.hpp"
#include "launcher/sweep/study_folder.hpp"

#include <functional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// The script of a job array: each task does its share of the keys in `STUDY/slurm/tasks`. Slurm does not queue it
/// again when a node dies: the sweep submits what is missing. At most `at_once` tasks at a time; 0: as many as Slurm
/// likes.
[[nodiscard]] std::string job_script(StudyFolder const& folder, std::size_t runs, std::size_t at_once, bool keep);

/// How many tasks the array has for so many runs: Slurm refuses more than 1001 (MaxArraySize) by default.
[[nodiscard]] std::size_t array_size(std::size_t runs);

/// Does runs as job arrays, and submits again what died with its node. `seen` is called once a second and says how many
/// are not there yet; false ends everything (scancel). A job of a sweep that was killed is followed, not submitted
/// twice. Fails when Slurm is not there or refuses the job, and when a whole array leaves no result.
[[nodiscard]] Result<void> run_on_slurm(StudyFolder const& folder, std::vector<std::string> const& keys,
                                        std::size_t at_once, bool keep, std::function<bool()> const& seen);

/// One task of an array, on its node: does every `of`-th key from the `task`-th (from 1) on, but for those that are
/// done.
[[nodiscard]] Result<void> do_task(StudyFolder const& folder, std::size_t task, std::size_t of, bool keep,
                                   InterruptWatch& interrupts);

} // namespace gridspace::launcher
