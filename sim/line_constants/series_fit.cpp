// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/line_constants/series_fit.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace gridspace::sim {
namespace {

constexpr int kCornersPerDecade = 4;
/// Corners lie this factor below and above the samples.
constexpr double kBeyondSamples = 10;
/// Of the gradient, below which nothing is gained any more.
constexpr double kNoGain = 1e-12;

/// x >= 0 with the least |m x - b|.
Eigen::VectorXd non_negative_least_squares(Eigen::MatrixXd const& m, Eigen::VectorXd const& b) {
    Eigen::Index const n = m.cols();
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> in; // columns that may be positive
    auto const solve = [&] {
        Eigen::MatrixXd part(m.rows(), static_cast<Eigen::Index>(in.size()));
        for (std::size_t k = 0; k < in.size(); ++k) {
            part.col(static_cast<Eigen::Index>(k)) = m.col(in[k]);
        }
        return Eigen::VectorXd{part.colPivHouseholderQr().solve(b)};
    };
    for (Eigen::Index round = 0; round < 3 * n; ++round) {
        Eigen::VectorXd gradient = m.transpose() * (b - m * x);
        for (Eigen::Index const k : in) {
            gradient[k] = 0;
        }
        Eigen::Index best = 0;
        if (gradient.maxCoeff(&best) < kNoGain || static_cast<Eigen::Index>(in.size()) == m.rows()) {
            break;
        }
        in.push_back(best);
        for (Eigen::VectorXd part = solve(); !in.empty(); part = solve()) {
            double step = 1;
            for (std::size_t k = 0; k < in.size(); ++k) {
                double const to = part[static_cast<Eigen::Index>(k)];
                if (to <= 0) {
                    step = std::min(step, x[in[k]] / (x[in[k]] - to));
                }
            }
            std::vector<Eigen::Index> left;
            for (std::size_t k = 0; k < in.size(); ++k) {
                double& value = x[in[k]];
                value += step * (part[static_cast<Eigen::Index>(k)] - value);
                if (step == 1 || value > 1e-14 * x.maxCoeff()) {
                    left.push_back(in[k]);
                } else {
                    value = 0;
                }
            }
            bool const done = left.size() == in.size();
            in = std::move(left);
            if (done) {
                break;
            }
        }
    }
    return x;
}

} // namespace

SeriesImpedance fit_series(std::vector<double> const& omega, std::vector<std::complex<double>> const& z) {
    SeriesImpedance out;
    double const low = omega.front() / kBeyondSamples, high = omega.back() * kBeyondSamples;
    double const ratio = std::pow(10.0, 1.0 / kCornersPerDecade);
    for (double corner = low; corner < high * ratio; corner *= ratio) {
        out.corners.push_back(corner);
    }
    auto const n = static_cast<Eigen::Index>(omega.size()), stages = static_cast<Eigen::Index>(out.corners.size());
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(2 * n, stages + 2);
    for (Eigen::Index i = 0; i < n; ++i) {
        double const w = omega[static_cast<std::size_t>(i)];
        std::complex<double> const value = z[static_cast<std::size_t>(i)];
        m(i, 0) = 1 / value.real();
        m(n + i, 1) = w / value.imag();
        for (Eigen::Index k = 0; k < stages; ++k) {
            double const corner = out.corners[static_cast<std::size_t>(k)];
            std::complex<double> const stage = std::complex<double>{0, w * corner} / std::complex<double>{corner, w};
            m(i, k + 2) = stage.real() / value.real();
            m(n + i, k + 2) = stage.imag() / value.imag();
        }
    }
    Eigen::VectorXd const length = m.colwise().norm();
    Eigen::VectorXd const x =
        non_negative_least_squares(m * length.cwiseInverse().asDiagonal(), Eigen::VectorXd::Ones(2 * n))
            .cwiseQuotient(length);
    out.r_ohm = x[0];
    out.l_h = x[1];
    out.inductances.assign(x.data() + 2, x.data() + x.size());
    return out;
}

double series_error(std::vector<double> const& omega, std::vector<std::complex<double>> const& z,
                    SeriesImpedance const& fit) {
    double sum = 0;
    for (std::size_t i = 0; i < omega.size(); ++i) {
        std::complex<double> const got = fit.at(omega[i]);
        sum += std::pow(got.real() / z[i].real() - 1, 2) + std::pow(got.imag() / z[i].imag() - 1, 2);
    }
    return std::sqrt(sum / (2.0 * static_cast<double>(omega.size())));
}

} // namespace gridspace::sim
