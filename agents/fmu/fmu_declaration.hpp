// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/fmu/fmu_table.hpp"
#include "common/program/declaration.hpp"

namespace gridspace::agents {

/// What an FMU agent with these settings does. `table`, of `description`: made of its FMU; for what it watches.
[[nodiscard]] program::Declaration declaration(FmuConfig const& config, fmi::ModelDescription const& description,
                                               FmuTable const& table);
/// Without an FMU.
[[nodiscard]] program::Declaration fmu_declaration();

} // namespace gridspace::agents
