// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "fmi/archive_writer.hpp"
#include "sim/engine/engine.hpp"
#include "sim/fmu/grid_inputs.hpp"
#include "sim/solvers/engine_settings.hpp"

#include <string>
#include <vector>

namespace gridspace::launcher {

/// A network to be exported.
struct GridToExport {
    std::string name;
    sim::EngineSettings engine;
    Rational stop_s{1};                  ///< of the default experiment
    std::vector<fmi::ArchiveFile> files; ///< of the network (network_files)
    std::vector<sim::GridInput> inputs;  ///< those that it shall have
    std::vector<sim::SignalDef> outputs;
    std::string binary; ///< octets of the library that runs it
};

/// The FMU (FMI 3.0, co-simulation) as a zip file. The same grid gives the same octets.
[[nodiscard]] Result<std::string> make_grid_fmu(GridToExport const& grid);

/// The name of its binary: of the network's name what an identifier of C may have.
[[nodiscard]] std::string model_identifier(std::string const& name);

} // namespace gridspace::launcher
