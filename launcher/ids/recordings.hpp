// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "ids/training/training_config.hpp"

#include <functional>

namespace gridspace::cli {

/// All recordings of a configuration: closed form, files, and runs of the simulator. `unseen` draws others from the
/// same ranges than the ones that are trained on, and leaves out the files; it fails where there is nothing else.
/// `progress(done, of)` is called as simulated runs finish.
[[nodiscard]] Result<std::vector<ids::LineWaveform>>
all_recordings(ids::TrainingConfig const& config, std::uint64_t seed, bool unseen,
               std::function<void(std::size_t, std::size_t)> const& progress = {});

} // namespace gridspace::cli
