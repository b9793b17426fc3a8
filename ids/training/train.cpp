// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/training/train.hpp"

#include "ids/training/linear_training.hpp"
#include "ids/training/network_training.hpp"

#include "ids/forecaster/forecaster.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::ids {

Result<Model> train(Windows const& data, Model like, TrainParams const& params, std::uint64_t seed,
                    Progress const& progress) {
    bool const linear =
        params.method == TrainParams::Method::least_squares || params.method == TrainParams::Method::huber;
    if (linear != (params.hidden == 0)) {
        return fail(ExitCode::usage,
                    linear ? "least squares and Huber train models without hidden neurons"
                           : "a network needs at least one hidden neuron",
                    linear ? "set hidden: 0, or another method" : "set hidden: 10, or method: huber");
    }
    std::size_t const parameters =
        linear ? data.inputs
               : static_cast<std::size_t>(params.hidden) * (data.inputs + data.outputs + 1) + data.outputs;
    if (data.count() < 2 * parameters) {
        return fail(ExitCode::usage, fmt::format("{} windows for {} parameters", data.count(), parameters),
                    "give longer or more recordings");
    }
    if (linear) {
        Layer layer{static_cast<int>(data.inputs),
                    static_cast<int>(data.outputs),
                    Layer::Activation::linear,
                    {},
                    std::vector<double>(data.outputs)};
        for (std::size_t o = 0; o < data.outputs; ++o) {
            auto taps = fit_linear(data, o, params, progress);
            if (!taps) {
                return std::unexpected{taps.error()};
            }
            layer.weights.insert(layer.weights.end(), taps->begin(), taps->end());
        }
        like.layers = {std::move(layer)};
    } else {
        initialise_network(like, params.hidden, seed);
        auto const done = params.method == TrainParams::Method::back_propagation
                              ? back_propagate(like, data, params, seed, progress)
                              : levenberg_marquardt(like, data, params, progress);
        if (!done) {
            return std::unexpected{done.error()};
        }
    }
    if (auto const ok = check(like); !ok) {
        return std::unexpected{ok.error()};
    }
    return like;
}

double rms_error(Model const& model, Windows const& data) {
    Model scaled = model; // the data are already divided by the scale
    scaled.scale = Model::Scale::fixed;
    scaled.scale_a = 1;
    Forecaster<double> forecaster{scaled};
    std::vector<double> next(data.outputs);
    double squares = 0;
    for (std::size_t k = 0; k < data.count(); ++k) {
        forecaster.forecast(&data.x[k * data.inputs], next.data());
        for (std::size_t o = 0; o < data.outputs; ++o) {
            double const e = next[o] - data.y[k * data.outputs + o];
            squares += e * e;
        }
    }
    return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(data.count() * data.outputs, 1)));
}

} // namespace gridspace::ids
