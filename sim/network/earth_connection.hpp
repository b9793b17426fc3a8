// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

#include <cstddef>
#include <optional>

namespace gridspace::sim {

/// The first bus whose zero sequence voltage nothing defines, with the breakers as they are at the start: no source, no
/// earthed star point of a machine or transformer, no load, shunt, converter filter or line capacitance is connected to
/// it. Waveforms of such a part have no solution, and phasors would hide that.
[[nodiscard]] std::optional<std::size_t> unearthed_bus(Network const& network);

} // namespace gridspace::sim
