// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/forecaster/model.hpp"

#include "common/elementary.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::ids {
namespace {

constexpr int kMaxWidth = 4096;

bool all_finite(std::vector<double> const& values) {
    for (double const v : values) {
        if (!std::isfinite(v)) {
            return false;
        }
    }
    return true;
}

Model linear(char const* kind, double rate_hz, double frequency_hz, std::vector<double> taps) {
    Model m;
    m.name = m.kind = kind;
    m.window = static_cast<int>(taps.size());
    m.rate_hz = rate_hz;
    m.frequency_hz = frequency_hz;
    m.layers = {{m.window, 1, Layer::Activation::linear, std::move(taps), {0}}};
    return m;
}

} // namespace

int Model::parameters() const {
    std::size_t count = 0;
    for (Layer const& layer : layers) {
        count += layer.weights.size() + layer.bias.size();
    }
    return static_cast<int>(count);
}

Result<void> check(Model const& model) {
    auto const bad = [&](std::string what) {
        return fail(ExitCode::usage, fmt::format("model '{}': {}", model.name, what),
                    "train it again with `gridspace ids train`");
    };
    if (model.window < 1 || model.window > kMaxWidth) {
        return bad(fmt::format("a window of {} samples; 1 to {} are possible", model.window, kMaxWidth));
    }
    if (model.channels != 1 && model.channels != 3) {
        return bad(fmt::format("{} channels; 1 or 3 are possible", model.channels));
    }
    if (!(model.rate_hz > 0) || !(model.frequency_hz > 0) || !std::isfinite(model.rate_hz) ||
        !std::isfinite(model.frequency_hz)) {
        return bad("rate and frequency must be positive");
    }
    if (!(model.scale_a > 0) || !std::isfinite(model.scale_a)) {
        return bad(fmt::format("a scale of {} A; it must be positive", model.scale_a));
    }
    if (model.layers.empty()) {
        return bad("no layers");
    }
    int inputs = model.window * model.channels;
    for (std::size_t k = 0; k < model.layers.size(); ++k) {
        Layer const& layer = model.layers[k];
        if (layer.inputs != inputs) {
            return bad(fmt::format("layer {} takes {} inputs, and {} come", k + 1, layer.inputs, inputs));
        }
        if (layer.outputs < 1 || layer.outputs > kMaxWidth) {
            return bad(fmt::format("layer {} has {} outputs", k + 1, layer.outputs));
        }
        auto const expected = static_cast<std::size_t>(layer.inputs) * static_cast<std::size_t>(layer.outputs);
        if (layer.weights.size() != expected) {
            return bad(fmt::format("layer {} has {} weights; {} x {} = {} expected", k + 1, layer.weights.size(),
                                   layer.outputs, layer.inputs, expected));
        }
        if (layer.bias.size() != static_cast<std::size_t>(layer.outputs)) {
            return bad(fmt::format("layer {} has {} biases; {} expected", k + 1, layer.bias.size(), layer.outputs));
        }
        if (!all_finite(layer.weights) || !all_finite(layer.bias)) {
            return bad(fmt::format("layer {} has a weight that is not a finite number", k + 1));
        }
        inputs = layer.outputs;
    }
    if (inputs != model.channels) {
        return bad(fmt::format("the last layer has {} outputs; {} expected, one per channel", inputs, model.channels));
    }
    return {};
}

Model oscillator(double rate_hz, double frequency_hz) {
    return linear("oscillator", rate_hz, frequency_hz,
                  {-1, 2 * elementary::cos(6.283185307179586 * frequency_hz / rate_hz)});
}

Model hold_last(double rate_hz, double frequency_hz) {
    return linear("hold_last", rate_hz, frequency_hz, {1});
}

} // namespace gridspace::ids
