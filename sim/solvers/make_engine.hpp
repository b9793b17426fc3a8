// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"
#include "sim/solvers/engine_settings.hpp"

#include <memory>

namespace gridspace::sim {

/// The solver of a network, with its tap changers and fuses at work.
[[nodiscard]] Result<std::unique_ptr<Engine>> make_engine(EngineSettings const& settings, Network network,
                                                          TimeBase base);

} // namespace gridspace::sim
