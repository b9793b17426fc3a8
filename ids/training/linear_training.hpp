// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/training/train.hpp"

namespace gridspace::ids {

/// The taps of a linear forecast of one output without a constant, so that it is the same at every amplitude: normal
/// equations, solved once, or again and again with Huber's weights.
[[nodiscard]] Result<std::vector<double>> fit_linear(Windows const& data, std::size_t output, TrainParams const& params,
                                                     Progress const& progress);

} // namespace gridspace::ids
