// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/export/run_source.hpp"

#include <functional>
#include <map>

namespace gridspace::dataset {

/// What was written of a run.
struct ExportedRun {
    struct Vantage {
        std::string name;                      ///< "process_bus", "process_bus/mu21:attacker"
        std::string file;                      ///< of its files, without the ending
        std::uint64_t frames{0}, altered{0};   ///< in its capture
        std::uint64_t samples{0}, messages{0}; ///< rows of features
    };
    struct Attack {
        std::uint64_t altered_frames{0}; ///< at all vantage points together
        std::int64_t first_ns{0}, last_ns{0};
    };
    std::vector<Vantage> vantages;         ///< by name
    std::map<std::string, Attack> attacks; ///< that altered frames of the capture
};

/// Writes captures, features and labels of a run into `folder`, which is there. `progress(frames)` is called now and
/// then. Memory does not grow with the length of the run.
[[nodiscard]] Result<ExportedRun> export_run(RunSource const& run, std::filesystem::path const& folder,
                                             std::function<void(std::uint64_t)> const& progress);

} // namespace gridspace::dataset
