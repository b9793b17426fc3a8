// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/forecaster/forecaster.hpp"

#include "ids/forecaster/double_pairs.hpp"
#include "ids/forecaster/squash.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace gridspace::ids {
namespace {

constexpr std::size_t kTogether = 4;

/// The largest magnitude, at least `least`; what is no number does not count. Which of them is compared with which
/// changes nothing, so four chains run side by side.
template <class Real>
Real peak_of(Real const* values, std::size_t count, Real least) {
    std::array<Real, kTogether> peaks;
    peaks.fill(least);
    auto const look = [&](std::size_t i, std::size_t k) {
        Real const magnitude = std::fabs(values[i + k]);
        peaks[k] = magnitude > peaks[k] ? magnitude : peaks[k];
    };
    std::size_t i = 0;
    for (; i + kTogether <= count; i += kTogether) {
        for (std::size_t k = 0; k < kTogether; ++k) {
            look(i, k);
        }
    }
    for (; i < count; ++i) {
        look(i, 0);
    }
    return std::ranges::max(peaks);
}

/// As many neurons side by side as fit, from neuron `o` on: of each its bias, and its inputs in their order. The sums
/// of one neuron wait for each other, so the more of them at once the better, as long as there are registers.
template <std::size_t pairs, class Dense>
[[gnu::flatten]] void add_up_pairs(Dense const& layer, double const* inputs, std::size_t& o, double* out) {
    for (; o + 2 * pairs <= layer.outputs; o += 2 * pairs) {
        auto sums = DoublePairs<pairs>::from(layer.bias.data() + o);
        double const* column = layer.columns.data() + o;
        for (std::size_t i = 0; i < layer.inputs; ++i, column += layer.outputs) {
            sums = sums + DoublePairs<pairs>::from(column) * inputs[i];
        }
        sums.to(out + o);
    }
}

template <class Real, class Dense>
void add_up(Dense const& layer, Real const* inputs, Real* out) {
    std::size_t o = 0;
    if constexpr (sizeof(Real) == sizeof(double)) {
        add_up_pairs<5>(layer, inputs, o, out);
        add_up_pairs<1>(layer, inputs, o, out);
    }
    for (; o < layer.outputs; ++o) {
        Real sum = layer.bias[o];
        Real const* column = layer.columns.data() + o;
        for (std::size_t i = 0; i < layer.inputs; ++i, column += layer.outputs) {
            sum += inputs[i] * *column;
        }
        out[o] = sum;
    }
}

constexpr std::size_t kPhases = 3;

/// One neuron for three phases, `layer.inputs` apart. The sum of each waits for itself alone.
template <class Real, class Dense>
std::array<Real, kPhases> add_up_phases(Dense const& layer, Real const* inputs) {
    Real const* const weights = layer.columns.data();
    std::size_t const n = layer.inputs;
    Real a = layer.bias[0], b = a, c = a;
    for (std::size_t i = 0; i < n; ++i) {
        a += inputs[i] * weights[i];
        b += inputs[n + i] * weights[i];
        c += inputs[2 * n + i] * weights[i];
    }
    return {a, b, c};
}

} // namespace

template <class Real>
Forecaster<Real>::Forecaster(Model const& model)
    : window_{model.window}, channels_{model.channels}, scale_by_peak_{model.scale == Model::Scale::window_peak},
      scale_a_{static_cast<Real>(model.scale_a)} {
    assert(check(model));
    std::size_t widest = static_cast<std::size_t>(window_) * kPhases;
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
Real Forecaster<Real>::scaled(Real const* history, std::size_t count, Real* to) const {
    Real const scale = scale_by_peak_ ? peak_of(history, count, scale_a_) : scale_a_;
    Real const inverse = 1 / scale;
    std::transform(history, history + count, to, [inverse](Real value) { return value * inverse; });
    return scale;
}

template <class Real>
void Forecaster<Real>::forecast(Real const* history, Real* next) {
    std::size_t const count = static_cast<std::size_t>(window_) * static_cast<std::size_t>(channels_);
    Real const scale = scaled(history, count, a_.data());
    for (Dense const& layer : layers_) {
        add_up(layer, a_.data(), b_.data());
        if (layer.squash) {
            squash(b_.data(), layer.outputs);
        }
        std::swap(a_, b_);
    }
    for (int c = 0; c < channels_; ++c) {
        next[c] = a_[static_cast<std::size_t>(c)] * scale;
    }
}

template <class Real>
void Forecaster<Real>::forecast_phases(Real const* history, Real* next) {
    auto const n = static_cast<std::size_t>(window_);
    Dense const& first = layers_.front();
    if (channels_ == kPhases) {
        forecast(history, next);
    } else if (layers_.size() == 1 && !first.squash) {
        std::array<Real, kPhases> scales;
        for (std::size_t p = 0; p < kPhases; ++p) {
            scales[p] = scaled(history + p * n, n, a_.data() + p * n);
        }
        std::array<Real, kPhases> const sums = add_up_phases(first, a_.data());
        for (std::size_t p = 0; p < kPhases; ++p) {
            next[p] = sums[p] * scales[p];
        }
    } else {
        for (std::size_t p = 0; p < kPhases; ++p) {
            forecast(history + p * n, next + p);
        }
    }
}

template class Forecaster<double>;
template class Forecaster<float>;

} // namespace gridspace::ids
