// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/sweep/run_record.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Where the parts of a study are.
struct StudyFolder {
    std::filesystem::path root; ///< absolute
    [[nodiscard]] std::filesystem::path of_run(std::string const& key) const { return root / "runs" / key; }
    [[nodiscard]] std::filesystem::path scenario(std::string const& key) const { return of_run(key) / "scenario.yaml"; }
    [[nodiscard]] std::filesystem::path record(std::string const& key) const { return of_run(key) / "record.json"; }
    [[nodiscard]] std::filesystem::path run(std::string const& key) const { return of_run(key) / "run"; }
    [[nodiscard]] std::filesystem::path output(std::string const& key) const { return of_run(key) / "output.log"; }
    /// What repeats the run, from anywhere.
    [[nodiscard]] std::string command(std::string const& key) const;
};

/// A word of a shell's command line, in quotes where it needs them.
[[nodiscard]] std::string shell_word(std::string const& text);

/// What does a run whose scenario is in its folder; what a sweep that was killed has left of it goes.
[[nodiscard]] std::vector<std::string> begin_run(StudyFolder const& folder, std::string const& key);

/// Writes down how the run went, and then lets go what nobody needs: all of a run that passed, unless `keep`.
[[nodiscard]] Result<RunRecord> end_run(StudyFolder const& folder, std::string const& key, int exit, double wall_s,
                                        bool keep);

} // namespace gridspace::launcher
