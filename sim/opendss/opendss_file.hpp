// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/opendss/circuit.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::opendss {

struct ScriptOptions {
    std::vector<std::filesystem::path> folders; ///< beside the script's own, from which it may read
    std::vector<std::string> commands;          ///< of OpenDSS, carried out after the script
    std::optional<double> hour;                 ///< at which daily load shapes are read
};

/// Whether a file's name says that it is an OpenDSS script: it ends in .dss.
[[nodiscard]] bool is_script(std::filesystem::path const& file);

/// The circuit of a script. Files that it redirects to are read when they lie in the folder of the script, below it, or
/// in one of `folders`; their names may be written in another case.
[[nodiscard]] std::optional<Circuit> load_circuit(std::filesystem::path const& file, ScriptOptions const& options,
                                                  config::Diagnostics& diagnostics);

} // namespace gridspace::opendss
