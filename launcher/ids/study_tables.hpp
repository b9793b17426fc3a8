// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/evaluation/study.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::cli {

/// What `gridspace ids study` found.
struct StudyResults {
    std::vector<ids::ShapeResult> shapes;
    std::string network;                         ///< name of the network under fakes, as 20-10-1
    std::vector<ids::FakesResult> network_fakes; ///< the published loop with that network
    std::vector<ids::FakesResult> linear_fakes;  ///< and with a linear forecaster of the same window
};

/// For people.
[[nodiscard]] std::string study_text(StudyResults const& results);
/// For programs; `folder` is where the files are.
[[nodiscard]] std::string study_json(StudyResults const& results, std::filesystem::path const& folder);
/// shapes.csv, shapes.svg, fakes.csv, fakes.svg into `folder`, which is made.
[[nodiscard]] Result<void> write_study(StudyResults const& results, std::filesystem::path const& folder);

} // namespace gridspace::cli
