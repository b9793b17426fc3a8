// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/export/run_export.hpp"

namespace gridspace::dataset {

struct DataSetOptions {
    std::filesystem::path out; ///< not there yet, or empty
    std::uint64_t seed{1};     ///< of the splits
    std::string command;       ///< that repeats it, for the data card
};

/// A run in the data set.
struct DataSetRun {
    RunSource source;
    ExportedRun exported;
    std::string split_by_grid, split_by_attack;
};

struct DataSet {
    std::vector<DataSetRun> runs;
    std::uint64_t files{0}, octets{0};
};

/// Says which part of the data each run is for.
void assign_splits(std::vector<DataSetRun>& runs, std::uint64_t seed);

/// Reads all runs before anything is written, and writes the data set; manifest.json is last, so one without it is not
/// whole. The same runs and seed give the same octets. `progress(run, frames)`.
[[nodiscard]] Result<DataSet> write_data_set(std::vector<RunSource> runs, DataSetOptions const& options,
                                             std::function<void(std::string const&, std::uint64_t)> const& progress);

} // namespace gridspace::dataset
