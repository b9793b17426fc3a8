// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/training/network_training.hpp"

#include "common/elementary.hpp"
#include "common/random.hpp"
#include "ids/training/cholesky.hpp"
#include "ids/training/chunks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace gridspace::ids {
namespace {

constexpr std::size_t kWindowsAtOnce = 512;

/// The parameters as one vector: W1, b1, W2, b2.
struct Shape {
    std::size_t inputs, hidden, outputs;
    [[nodiscard]] std::size_t b1() const { return inputs * hidden; }
    [[nodiscard]] std::size_t w2() const { return b1() + hidden; }
    [[nodiscard]] std::size_t b2() const { return w2() + hidden * outputs; }
    [[nodiscard]] std::size_t count() const { return b2() + outputs; }
};

Shape shape_of(Model const& m) {
    return {static_cast<std::size_t>(m.layers[0].inputs), static_cast<std::size_t>(m.layers[0].outputs),
            static_cast<std::size_t>(m.layers[1].outputs)};
}

std::vector<double> flatten(Model const& m) {
    std::vector<double> out;
    for (Layer const& layer : m.layers) {
        out.insert(out.end(), layer.weights.begin(), layer.weights.end());
        out.insert(out.end(), layer.bias.begin(), layer.bias.end());
    }
    return out;
}

void unflatten(std::vector<double> const& parameters, Model& m) {
    auto at = parameters.begin();
    for (Layer& layer : m.layers) {
        for (std::vector<double>* part : {&layer.weights, &layer.bias}) {
            std::copy_n(at, part->size(), part->begin());
            at += static_cast<std::ptrdiff_t>(part->size());
        }
    }
}

/// Twice Huber's loss, which is the square for small errors; and the weight that makes a square of it.
double loss_of(double e, double limit) {
    double const magnitude = std::fabs(e);
    return magnitude <= limit ? e * e : 2 * limit * magnitude - limit * limit;
}
double weight_of(double e, double limit) {
    double const magnitude = std::fabs(e);
    return magnitude <= limit ? 1 : limit / magnitude;
}

/// Activations of the hidden layer and the outputs for one window.
void run(Shape const& s, std::vector<double> const& q, double const* x, double* hidden, double* out) {
    for (std::size_t h = 0; h < s.hidden; ++h) {
        double sum = q[s.b1() + h];
        for (std::size_t i = 0; i < s.inputs; ++i) {
            sum += q[h * s.inputs + i] * x[i];
        }
        hidden[h] = elementary::tanh(sum);
    }
    for (std::size_t o = 0; o < s.outputs; ++o) {
        double sum = q[s.b2() + o];
        for (std::size_t h = 0; h < s.hidden; ++h) {
            sum += q[s.w2() + o * s.hidden + h] * hidden[h];
        }
        out[o] = sum;
    }
}

double total_loss(Shape const& s, std::vector<double> const& q, Windows const& data, TrainParams const& params) {
    std::size_t const chunks = (data.count() + kWindowsAtOnce - 1) / kWindowsAtOnce;
    std::vector<double> parts(chunks);
    for_each_chunk(chunks, params.threads, [&](std::size_t c) {
        std::vector<double> hidden(s.hidden), out(s.outputs);
        for (std::size_t k = c * kWindowsAtOnce; k < std::min((c + 1) * kWindowsAtOnce, data.count()); ++k) {
            run(s, q, &data.x[k * s.inputs], hidden.data(), out.data());
            for (std::size_t o = 0; o < s.outputs; ++o) {
                double const e = out[o] - data.y[k * s.outputs + o];
                parts[c] += loss_of(e, params.error_limit);
            }
        }
    });
    return std::accumulate(parts.begin(), parts.end(), 0.0);
}

struct GaussNewton {
    std::vector<double> a, g; ///< J' J (lower triangle) and J' e
};

GaussNewton linearise(Shape const& s, std::vector<double> const& q, Windows const& data, TrainParams const& params) {
    std::size_t const n = s.count(), chunks = (data.count() + kWindowsAtOnce - 1) / kWindowsAtOnce;
    // One accumulator per group of chunks: as many as chunks would not fit into memory, one per thread would not
    // repeat.
    std::size_t const groups = std::min<std::size_t>(chunks, 8);
    std::vector<GaussNewton> parts(groups);
    for_each_chunk(groups, params.threads, [&](std::size_t group) {
        GaussNewton part{std::vector<double>(n * n), std::vector<double>(n)};
        std::vector<double> hidden(s.hidden), out(s.outputs), row(n);
        for (std::size_t k = group * data.count() / groups; k < (group + 1) * data.count() / groups; ++k) {
            double const* const x = &data.x[k * s.inputs];
            run(s, q, x, hidden.data(), out.data());
            for (std::size_t o = 0; o < s.outputs; ++o) {
                std::fill(row.begin(), row.end(), 0.0);
                for (std::size_t h = 0; h < s.hidden; ++h) {
                    double const slope = q[s.w2() + o * s.hidden + h] * (1 - hidden[h] * hidden[h]);
                    for (std::size_t i = 0; i < s.inputs; ++i) {
                        row[h * s.inputs + i] = slope * x[i];
                    }
                    row[s.b1() + h] = slope;
                    row[s.w2() + o * s.hidden + h] = hidden[h];
                }
                row[s.b2() + o] = 1;
                double const e = out[o] - data.y[k * s.outputs + o];
                double const weight = weight_of(e, params.error_limit);
                for (std::size_t i = 0; i < n; ++i) {
                    double const r = weight * row[i];
                    if (r == 0) {
                        continue;
                    }
                    double* const line = &part.a[i * n];
                    for (std::size_t j = 0; j <= i; ++j) {
                        line[j] += r * row[j];
                    }
                    part.g[i] += r * e;
                }
            }
        }
        parts[group] = std::move(part);
    });
    for (std::size_t group = 1; group < groups; ++group) {
        for (std::size_t k = 0; k < n * n; ++k) {
            parts[0].a[k] += parts[group].a[k];
        }
        for (std::size_t k = 0; k < n; ++k) {
            parts[0].g[k] += parts[group].g[k];
        }
    }
    return std::move(parts[0]);
}

} // namespace

void initialise_network(Model& model, int hidden, std::uint64_t seed) {
    Random random{seed, "weights"};
    auto layer = [&](int inputs, int outputs, Layer::Activation activation) {
        Layer out{inputs, outputs, activation, {}, std::vector<double>(static_cast<std::size_t>(outputs))};
        double const bound = std::sqrt(6.0 / (inputs + outputs));
        for (int k = 0; k < inputs * outputs; ++k) {
            out.weights.push_back(random.uniform(-bound, bound));
        }
        return out;
    };
    model.layers = {layer(model.window * model.channels, hidden, Layer::Activation::tanh),
                    layer(hidden, model.channels, Layer::Activation::linear)};
}

Result<void> back_propagate(Model& model, Windows const& data, TrainParams const& params, std::uint64_t seed,
                            Progress const& progress) {
    Shape const s = shape_of(model);
    std::vector<double> q = flatten(model), velocity(q.size()), gradient(q.size()), hidden(s.hidden), out(s.outputs),
                        back(s.hidden);
    std::vector<std::size_t> order(data.count());
    std::iota(order.begin(), order.end(), 0U);
    Random random{seed, "order"};
    for (int epoch = 1; epoch <= params.epochs; ++epoch) {
        for (std::size_t k = order.size(); k > 1; --k) {
            std::swap(order[k - 1], order[random.below(k)]);
        }
        // The rate falls to a twentieth along a line: large steps find the valley, small ones its floor.
        double const rate = params.rate * (1 - 0.95 * (epoch - 1) / std::max(params.epochs - 1, 1));
        double squares = 0;
        auto const batch = static_cast<std::size_t>(std::max(params.batch, 1));
        for (std::size_t begin = 0; begin < order.size(); begin += batch) {
            std::size_t const end = std::min(begin + batch, order.size());
            std::fill(gradient.begin(), gradient.end(), 0.0);
            for (std::size_t b = begin; b < end; ++b) {
                double const* const x = &data.x[order[b] * s.inputs];
                run(s, q, x, hidden.data(), out.data());
                std::fill(back.begin(), back.end(), 0.0);
                for (std::size_t o = 0; o < s.outputs; ++o) {
                    double e = out[o] - data.y[order[b] * s.outputs + o];
                    squares += loss_of(e, params.error_limit);
                    e *= weight_of(e, params.error_limit);
                    gradient[s.b2() + o] += e;
                    for (std::size_t h = 0; h < s.hidden; ++h) {
                        gradient[s.w2() + o * s.hidden + h] += e * hidden[h];
                        back[h] += e * q[s.w2() + o * s.hidden + h];
                    }
                }
                for (std::size_t h = 0; h < s.hidden; ++h) {
                    double const d = back[h] * (1 - hidden[h] * hidden[h]);
                    gradient[s.b1() + h] += d;
                    for (std::size_t i = 0; i < s.inputs; ++i) {
                        gradient[h * s.inputs + i] += d * x[i];
                    }
                }
            }
            for (std::size_t k = 0; k < q.size(); ++k) {
                velocity[k] = params.momentum * velocity[k] - rate * gradient[k] / static_cast<double>(end - begin);
                q[k] += velocity[k];
            }
        }
        double const rms = std::sqrt(squares / static_cast<double>(data.count() * s.outputs));
        if (!std::isfinite(rms)) {
            return fail(ExitCode::usage, fmt::format("back-propagation diverged in epoch {}", epoch), "lower `rate`");
        }
        if (progress && !progress(epoch, params.epochs, rms)) {
            break;
        }
    }
    unflatten(q, model);
    return {};
}

Result<void> levenberg_marquardt(Model& model, Windows const& data, TrainParams const& params,
                                 Progress const& progress) {
    Shape const s = shape_of(model);
    std::size_t const n = s.count();
    std::vector<double> q = flatten(model);
    double damping = 1e-2, loss = total_loss(s, q, data, params);
    for (int iteration = 1; iteration <= params.epochs; ++iteration) {
        GaussNewton const gn = linearise(s, q, data, params);
        bool improved = false;
        for (int attempt = 0; attempt < 10 && !improved; ++attempt) {
            std::vector<double> a = gn.a, step = gn.g;
            for (std::size_t i = 0; i < n; ++i) {
                a[i * n + i] += damping * (gn.a[i * n + i] + 1e-12);
            }
            std::vector<double> candidate = q;
            bool const solved = solve_positive_definite(a, step, n);
            for (std::size_t i = 0; solved && i < n; ++i) {
                candidate[i] -= step[i];
            }
            double const next = solved ? total_loss(s, candidate, data, params) : loss;
            if (solved && next < loss) {
                improved = true;
                q = candidate;
                loss = next;
                damping = std::max(damping / 5, 1e-12);
            } else {
                damping *= 5;
            }
        }
        if (!std::isfinite(loss)) {
            return fail(ExitCode::usage, "the loss is not a number",
                        "look for values that are not finite in the recordings");
        }
        if ((progress &&
             !progress(iteration, params.epochs, std::sqrt(loss / static_cast<double>(data.count() * s.outputs)))) ||
            !improved) {
            break;
        }
    }
    unflatten(q, model);
    return {};
}

} // namespace gridspace::ids
