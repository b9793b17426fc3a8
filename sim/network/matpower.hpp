// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

#include <filesystem>
#include <optional>

namespace gridspace::sim {

/// Reads a MATPOWER case (format version 1 or 2). Buses become B<number>, branches L<n> or T<n>, generators G<n>, loads
/// D<n>, n counting the rows from 1; what is out of service is left out. A bus without a base voltage gets 1 kV: p.u.
/// results do not depend on it.
[[nodiscard]] std::optional<Network> load_matpower(std::filesystem::path const& file, config::Diagnostics& diagnostics,
                                                   config::SourceMark named_at);

} // namespace gridspace::sim
