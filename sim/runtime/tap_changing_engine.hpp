// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <memory>

namespace gridspace::sim {

/// `engine` with the tap changers of its network at work; the same engine where there are none. A regulator measures
/// after each advance, and its step takes effect at that instant, before the next one. Signals:
/// `transformer.X.tap_position`. One with compensation
/// measures the current of its transformer as well.
[[nodiscard]] std::unique_ptr<Engine> with_tap_changers(std::unique_ptr<Engine> engine, Network const& network,
                                                        TimeBase const& base);

} // namespace gridspace::sim
