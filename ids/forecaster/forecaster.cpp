// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/forecaster/forecaster.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gridspace::ids {

template <class Real>
Forecaster<Real>::Forecaster(Model const& model)
    : window_{model.window}, channels_{model.channels}, scale_by_peak_{model.scale == Model::Scale::window_peak},
      scale_a_{static_cast<Real>(model.scale_a)} {
    assert(check(model));
    std::size_t widest = static_cast<std::size_t>(window_) * static_cast<std::size_t>(channels_);
    for (Layer const& layer : model.layers) {
        Dense d;
        d.inputs = static_cast<std::size_t>(layer.inputs);
        d.outputs = static_cast<std::size_t>(layer.outputs);
        d.squash = layer.activation == Layer::Activation::tanh;
        d.columns.resize(d.inputs * d.outputs);
        for (std::size_t o = 0; o < d.outputs; ++o) {
            for (std::size_t i = 0; i < d.inputs; ++i) {
                d.columns[i * d.outputs + o] = static_cast<Real>(layer.weights[o * d.inputs + i]);
            }
        }
        d.bias.assign(layer.bias.begin(), layer.bias.end());
        widest = std::max(widest, d.outputs);
        layers_.push_back(std::move(d));
    }
    a_.resize(widest);
    b_.resize(widest);
}

template <class Real>
void Forecaster<Real>::forecast(Real const* history, Real* next) {
    std::size_t const count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(channels_);
    Real scale = scale_a_;
    if (scale_by_peak_) {
        for (std::size_t i = 0; i < count; ++i) {
            Real const magnitude = std::fabs(history[i]);
            scale = magnitude > scale ? magnitude : scale;
        }
    }
    Real const inverse = 1 / scale;
    for (std::size_t i = 0; i < count; ++i) {
        a_[i] = history[i] * inverse;
    }
    for (Dense const& layer : layers_) {
        Real* const out = b_.data();
        std::copy(layer.bias.begin(), layer.bias.end(), out);
        for (std::size_t i = 0; i < layer.inputs; ++i) {
            Real const x = a_[i];
            Real const* const column = &layer.columns[i * layer.outputs];
            for (std::size_t o = 0; o < layer.outputs; ++o) {
                out[o] += x * column[o];
            }
        }
        if (layer.squash) {
            for (std::size_t o = 0; o < layer.outputs; ++o) {
                out[o] = elementary::tanh(out[o]);
            }
        }
        std::swap(a_, b_);
    }
    for (int c = 0; c < channels_; ++c) {
        next[c] = a_[static_cast<std::size_t>(c)] * scale;
    }
}

template class Forecaster<double>;
template class Forecaster<float>;

} // namespace gridspace::ids
