// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::cli {

struct DssArguments {
    std::filesystem::path script;
    bool json{false};
    std::filesystem::path csv; ///< voltages as a table; empty: none
    std::vector<std::filesystem::path> include;
    std::vector<std::string> commands;
    std::optional<double> hour;
};

/// `gridspace powerflow` of an OpenDSS script.
int powerflow_dss(DssArguments const& arguments);

} // namespace gridspace::cli
