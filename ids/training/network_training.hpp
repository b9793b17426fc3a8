// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/training/train.hpp"

namespace gridspace::ids {

/// Stochastic gradient descent with momentum; the order of the windows is shuffled anew for each epoch.
[[nodiscard]] Result<void> back_propagate(Model& model, Windows const& data, TrainParams const& params,
                                          std::uint64_t seed, Progress const& progress);

/// Levenberg and Marquardt: Gauss-Newton steps on all windows, damped more after a failure and less after a success.
[[nodiscard]] Result<void> levenberg_marquardt(Model& model, Windows const& data, TrainParams const& params,
                                               Progress const& progress);

/// A network of one hidden tanh layer with small random weights (Glorot).
void initialise_network(Model& model, int hidden, std::uint64_t seed);

} // namespace gridspace::ids
