// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/ids/design.hpp"
#include "ids/data/waveform.hpp"

#include <cstdint>
#include <span>

namespace gridspace {

/// A table of masquerades, so many, that begin at one end soon after a disturbance that both ends see: for how long
/// they inherit its permission.
Result<void> print_masquerade_timings(std::int64_t timings, int threads, GuardedRelay const& sut,
                                      std::span<ids::LineWaveform const> disturbed, ids::TrainingConfig const& config);

} // namespace gridspace
