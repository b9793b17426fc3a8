// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gridspace {

/// Writes one CSV per recorded topic (and one per group of signals) into `folder`: one header row; time_s first, then
/// the process, then the members of the type, nested ones as `evs_0_soc_percent`. Units are in the names, as in the
/// IDL.
struct CsvExport {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> notes; ///< what is left out, and why
};
/// A topic whose type or samples cannot be read is left out, with a note; a recording that was cut is exported as far
/// as it goes.
[[nodiscard]] Result<CsvExport> export_csv(std::filesystem::path const& mcap, std::int64_t epoch_ns,
                                           std::filesystem::path const& folder);

} // namespace gridspace
