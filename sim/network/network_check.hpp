// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

namespace gridspace::sim {

/// What one element alone cannot see: references, zero impedances, doubled devices, buses that nothing feeds.
/// All mistakes at once, at the place where they were written.
void check_network(Network const& network, config::Diagnostics& diagnostics);

} // namespace gridspace::sim
