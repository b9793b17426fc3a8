// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "ids/forecaster/model.hpp"
#include "ids/training/windows.hpp"

#include <cstdint>
#include <functional>

namespace gridspace::ids {

struct TrainParams {
    enum class Method {
        least_squares,
        huber,            ///< least squares that gives large errors (the samples after an event) less weight
        back_propagation, ///< stochastic gradient descent with momentum
        levenberg_marquardt,
    };
    Method method{Method::huber};
    int hidden{0};  ///< neurons; 0: linear
    int epochs{60}; ///< back-propagation: passes; Levenberg-Marquardt and Huber: iterations
    double rate{0.02}, momentum{0.9};
    int batch{32};
    double huber{1.345};      ///< linear: errors beyond so many robust standard deviations count linearly
    double error_limit{0.02}; ///< networks: errors beyond this, in scaled units, count linearly, not squared; a fault
                              ///< inside a window would otherwise outweigh thousands of ordinary samples
    double ridge{1e-9};       ///< of the mean square of the inputs
    int threads{2};           ///< changes the time, never a bit of the result
};

/// Called after each epoch or iteration: its number from 1, the root of the mean loss in scaled units. False: stop
/// there.
using Progress = std::function<bool(int epoch, int of, double rms)>;

/// Trains a linear or one-hidden-layer tanh model on `data`. `like` says window, channels, scale, rate and name; its
/// layers are made here. The same data, parameters and seed give the same bits whatever the number of threads. An error
/// when there are fewer windows than parameters, or the loss stops being a number.
[[nodiscard]] Result<Model> train(Windows const& data, Model like, TrainParams const& params, std::uint64_t seed,
                                  Progress const& progress = {});

/// Root mean square error of a model on data made with its window and scale; scaled units.
[[nodiscard]] double rms_error(Model const& model, Windows const& data);

} // namespace gridspace::ids
