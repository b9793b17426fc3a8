// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/solvers/engine_settings.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {

/// What the binary of an exported network finds next to the network in resources/: the same for who writes the FMU and
/// who runs it.
struct FmuSettings {
    static constexpr std::string_view kFile = "grid.yaml";

    EngineSettings engine;
    std::filesystem::path network; ///< relative to that file
    std::string token;             ///< instantiationToken of modelDescription.xml
    /// Names of variables. Value references count from 0: the time, the inputs, the outputs.
    std::vector<std::string> inputs, outputs;
};
void describe(config::Fields& f, FmuSettings& settings);
[[nodiscard]] std::string to_yaml(FmuSettings const& settings);

} // namespace gridspace::sim
