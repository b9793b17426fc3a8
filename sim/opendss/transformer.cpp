// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/transformer.hpp"

#include <Eigen/LU>
#include <cmath>
#include <complex>

namespace gridspace::opendss {
namespace {
using Complex = std::complex<double>;
}

double Transformer::winding_v(std::size_t winding) const {
    WindingData const& w = windings[winding];
    bool const of_phases = !w.delta && (phases == 2 || phases == 3);
    return w.kv * 1e3 / (of_phases ? std::sqrt(3.0) : 1.0);
}

std::pair<int, int> Transformer::ends(std::size_t winding, int phase) const {
    int const first = static_cast<int>(winding) * conductors(), neutral = first + phases;
    if (phases == 1 || !windings[winding].delta) {
        return {first + phase, neutral};
    }
    // In a bank of star and delta, the side of the higher voltage leads or lags by 30 degrees.
    int direction = 1;
    if (windings[0].delta != windings[1].delta) {
        bool const high_is_delta = windings[windings[0].kv >= windings[1].kv ? 0 : 1].delta;
        direction = high_is_delta == high_leads ? 1 : -1;
    }
    int next = phase + direction;
    if (phases > 2) {
        next = (next + phases) % phases;
    } else if (next < 0) {
        next = 2; // an open delta: the third corner
    }
    return {first + phase, first + next};
}

Eigen::MatrixXcd Transformer::admittance() const {
    auto const n = static_cast<int>(windings.size());
    // Of one phase, at one volt: short-circuit impedances seen from the first winding.
    double const z_base = phases / (windings[0].kva * 1e3);
    Eigen::MatrixXcd z = Eigen::MatrixXcd::Zero(n - 1, n - 1);
    auto const r = [&](int i) { return windings[static_cast<std::size_t>(i)].r_pu; };
    auto const pair = [&](int i, int j, std::size_t k) { return Complex{r(i) + r(j), x_pu[k]} * z_base; };
    for (int i = 0; i + 1 < n; ++i) {
        z(i, i) = pair(0, i + 1, static_cast<std::size_t>(i));
    }
    auto k = static_cast<std::size_t>(n - 1);
    for (int i = 0; i + 1 < n; ++i) {
        for (int j = i + 1; j + 1 < n; ++j) {
            z(i, j) = z(j, i) = (z(i, i) + z(j, j) - pair(i + 1, j + 1, k++)) / 2.0;
        }
    }
    Eigen::FullPivLU<Eigen::MatrixXcd> const lu{z};
    if (!lu.isInvertible()) {
        return {};
    }
    Eigen::MatrixXcd to_windings = Eigen::MatrixXcd::Zero(n - 1, n);
    to_windings.col(0).setConstant(-1);
    to_windings.rightCols(n - 1).setIdentity();
    Eigen::MatrixXcd one = to_windings.transpose() * lu.inverse() * to_windings;
    one(1, 1) += Complex{no_load_pu, -magnetising_pu} / z_base;
    // Each winding between its two ends, by its turns.
    int const order = n * conductors();
    Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(order, order);
    for (int phase = 0; phase < phases; ++phase) {
        Eigen::MatrixXcd place = Eigen::MatrixXcd::Zero(n, order);
        for (int w = 0; w < n; ++w) {
            auto const winding = static_cast<std::size_t>(w);
            auto const [a, b] = ends(winding, phase);
            double const tap = windings[winding].tap == 0 ? 1e-4 : windings[winding].tap;
            double const turns = 1 / (winding_v(winding) * tap);
            place(w, a) += turns;
            place(w, b) -= turns;
            double const v = winding_v(winding);
            Complex const floating{0, -float_share / 2 / (v * v * z_base)};
            out(a, a) += floating;
            out(b, b) += floating;
        }
        out += place.transpose() * one * place;
    }
    for (std::size_t w = 0; w < windings.size(); ++w) {
        WindingData const& data = windings[w];
        if (!data.delta && data.neutral_r_ohm >= 0) {
            auto const neutral = static_cast<int>(w + 1) * conductors() - 1;
            Complex const earth{data.neutral_r_ohm, data.neutral_x_ohm};
            out(neutral, neutral) += earth == Complex{} ? Complex{1e6} : 1.0 / earth;
        }
    }
    return out;
}

} // namespace gridspace::opendss
