// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/engine/engine.hpp"
#include "sim/network/network.hpp"

#include <memory>

namespace gridspace::sim {

/// `engine` with the fuses of its network at work; the same engine where there are none. A link measures after each
/// step, which waveforms do not have longer than `step`; when it melts, its arc begins at that instant, before the next
/// step. In waveforms each pole melts by its own current; in phasors the three do together, by that of the positive
/// sequence. Signals: `fuse.X.damage`, `fuse.X.melted_s` (in waveforms by pole: `.a`). Happenings: `fuse_melted`.
[[nodiscard]] std::unique_ptr<Engine> with_fuses(std::unique_ptr<Engine> engine, Network const& network,
                                                 TimeBase const& base, SimSpan step);

} // namespace gridspace::sim
