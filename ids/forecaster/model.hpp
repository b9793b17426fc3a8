// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>
#include <utility>
#include <vector>

namespace gridspace::ids {

/// One dense layer: y = activation(W x + b).
struct Layer {
    enum class Activation { linear, tanh };
    int inputs{0}, outputs{0};
    Activation activation{Activation::linear};
    std::vector<double> weights; ///< outputs x inputs, row by row
    std::vector<double> bias;    ///< outputs
    friend bool operator==(Layer const&, Layer const&) = default;
};

/// A one-step forecaster of sampled currents: from the last `window` samples of `channels` phases to the next sample of
/// each. Every kind we have (20-10-1 network, autoregression, oscillator, joint three-phase) is a stack of dense
/// layers.
///
/// Inputs are ordered phase by phase, oldest sample first, and divided by the scale; outputs are multiplied by it.
struct Model {
    enum class Scale {
        fixed,       ///< scale_a for every window
        window_peak, ///< the largest magnitude in the window, at least scale_a
    };
    std::string name;
    std::string kind; ///< for people: mlp, ar, oscillator, joint
    int window{0};
    int channels{1}; ///< 1: the same model for each phase; 3: all phases together
    double rate_hz{0}, frequency_hz{0};
    Scale scale{Scale::fixed};
    double scale_a{1};
    std::vector<Layer> layers;
    std::vector<std::pair<std::string, std::string>> provenance; ///< who trained it, from what, how well

    [[nodiscard]] int parameters() const;
    friend bool operator==(Model const&, Model const&) = default;
};

/// Whether the sizes fit together and every number is finite; the message names the layer.
[[nodiscard]] Result<void> check(Model const& model);

/// 2 cos(w) x[n-1] - x[n-2]: exact for a sinusoid of the nominal frequency.
[[nodiscard]] Model oscillator(double rate_hz, double frequency_hz);

/// The last value again: the least that a forecaster has to beat.
[[nodiscard]] Model hold_last(double rate_hz, double frequency_hz);

} // namespace gridspace::ids
