// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/training/linear_training.hpp"

#include "ids/training/cholesky.hpp"
#include "ids/training/chunks.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::ids {
namespace {

constexpr std::size_t kChunk = 4096; // windows; fixed, so that sums do not depend on the number of threads

struct Normal {
    std::vector<double> a, b; ///< X' W X (lower triangle), X' W y
};

/// Accumulates the weighted normal equations of one output.
Normal normal_equations(Windows const& data, std::size_t output, std::vector<double> const& weight, int threads) {
    std::size_t const n = data.inputs, chunks = (data.count() + kChunk - 1) / kChunk;
    std::vector<Normal> parts(chunks);
    for_each_chunk(chunks, threads, [&](std::size_t c) {
        Normal part{std::vector<double>(n * n), std::vector<double>(n)};
        for (std::size_t k = c * kChunk; k < std::min((c + 1) * kChunk, data.count()); ++k) {
            double const* const x = &data.x[k * n];
            double const w = weight[k], y = data.y[k * data.outputs + output];
            for (std::size_t i = 0; i < n; ++i) {
                double const wx = w * x[i];
                for (std::size_t j = 0; j <= i; ++j) {
                    part.a[i * n + j] += wx * x[j];
                }
                part.b[i] += wx * y;
            }
        }
        parts[c] = std::move(part);
    });
    Normal sum{std::vector<double>(n * n), std::vector<double>(n)};
    for (Normal const& part : parts) {
        for (std::size_t k = 0; k < n * n; ++k) {
            sum.a[k] += part.a[k];
        }
        for (std::size_t k = 0; k < n; ++k) {
            sum.b[k] += part.b[k];
        }
    }
    return sum;
}

double residual(Windows const& data, std::size_t k, std::size_t output, std::vector<double> const& taps) {
    double sum = -data.y[k * data.outputs + output];
    for (std::size_t i = 0; i < data.inputs; ++i) {
        sum += data.x[k * data.inputs + i] * taps[i];
    }
    return sum;
}

} // namespace

Result<std::vector<double>> fit_linear(Windows const& data, std::size_t output, TrainParams const& params,
                                       Progress const& progress) {
    std::size_t const n = data.inputs, count = data.count();
    std::vector<double> weight(count, 1.0), taps(n), r(count);
    int const iterations = params.method == TrainParams::Method::huber ? std::max(params.epochs, 1) : 1;
    for (int iteration = 1; iteration <= iterations; ++iteration) {
        Normal normal = normal_equations(data, output, weight, params.threads);
        double trace = 0;
        for (std::size_t i = 0; i < n; ++i) {
            trace += normal.a[i * n + i];
        }
        for (std::size_t i = 0; i < n; ++i) {
            normal.a[i * n + i] += params.ridge * trace / static_cast<double>(n);
        }
        if (!solve_positive_definite(normal.a, normal.b, n)) {
            return fail(ExitCode::usage, "the training data do not determine the taps (all windows alike, or all zero)",
                        "give more, and more varied, recordings");
        }
        double change = 0;
        for (std::size_t i = 0; i < n; ++i) {
            change = std::max(change, std::fabs(taps[i] - normal.b[i]));
        }
        taps = normal.b;
        double squares = 0;
        for (std::size_t k = 0; k < count; ++k) {
            r[k] = residual(data, k, output, taps);
            squares += r[k] * r[k];
        }
        if (progress && !progress(iteration, iterations, std::sqrt(squares / static_cast<double>(count)))) {
            break;
        }
        if (params.method != TrainParams::Method::huber || change < 1e-9) {
            break;
        }
        // Robust scale: the median magnitude over 0.6745, which is one standard deviation of normal noise.
        std::vector<double> magnitude(count);
        for (std::size_t k = 0; k < count; ++k) {
            magnitude[k] = std::fabs(r[k]);
        }
        auto const middle = magnitude.begin() + static_cast<std::ptrdiff_t>(count / 2);
        std::nth_element(magnitude.begin(), middle, magnitude.end());
        double const limit = std::max(params.huber * *middle / 0.6745, 1e-12);
        for (std::size_t k = 0; k < count; ++k) {
            weight[k] = std::fabs(r[k]) <= limit ? 1 : limit / std::fabs(r[k]);
        }
    }
    return taps;
}

} // namespace gridspace::ids
