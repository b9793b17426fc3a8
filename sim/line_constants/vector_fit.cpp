// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/line_constants/vector_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace gridspace::sim {
namespace {

using Complex = std::complex<double>;

/// How much more a sample counts that the function has to go through.
constexpr double kExactWeight = 1e4;
/// Neighbouring poles are at least so far apart: nearer ones make two equations of one.
constexpr double kLeastRatio = 1.05;

/// Least squares over real unknowns of complex equations, columns brought to one length first.
Eigen::VectorXd solve_rows(Eigen::MatrixXcd const& rows, Eigen::VectorXcd const& right) {
    Eigen::Index const n = rows.rows();
    Eigen::MatrixXd m(2 * n, rows.cols());
    Eigen::VectorXd b(2 * n);
    m << rows.real(), rows.imag();
    b << right.real(), right.imag();
    Eigen::VectorXd length = m.colwise().norm();
    length = (length.array() > 0).select(length, 1.0);
    m = m * length.cwiseInverse().asDiagonal();
    return m.colPivHouseholderQr().solve(b).cwiseQuotient(length);
}

/// Poles over the whole width of the samples, evenly on a logarithmic scale.
std::vector<double> first_poles(std::vector<double> const& omega, std::size_t samples, int count) {
    double const low = std::log(omega.front()), high = std::log(omega[samples - 1]);
    std::vector<double> out;
    for (int k = 0; k < count; ++k) {
        out.push_back(std::exp(low + (high - low) * (k + 0.5) / count));
    }
    return out;
}

/// The zeros of 1 + sum c / (s + p): where the poles go.
std::vector<double> moved(std::vector<double> const& poles, Eigen::VectorXd const& c) {
    auto const n = static_cast<Eigen::Index>(poles.size());
    Eigen::MatrixXd m = -Eigen::VectorXd::Ones(n) * c.transpose();
    for (Eigen::Index k = 0; k < n; ++k) {
        m(k, k) -= poles[static_cast<std::size_t>(k)];
    }
    Eigen::VectorXcd const zeros = m.eigenvalues();
    std::vector<double> out;
    for (Eigen::Index k = 0; k < n; ++k) {
        out.push_back(std::abs(zeros[k].real()));
    }
    std::sort(out.begin(), out.end());
    for (std::size_t k = 1; k < out.size(); ++k) {
        out[k] = std::max(out[k], kLeastRatio * out[k - 1]);
    }
    return out;
}

/// Columns 1 / (s + p), and one of ones, times the weight of each sample.
Eigen::MatrixXcd fractions(FrequencyResponse const& r, std::size_t samples, std::vector<double> const& poles) {
    auto const n = static_cast<Eigen::Index>(poles.size());
    Eigen::MatrixXcd out(static_cast<Eigen::Index>(samples), n + 1);
    for (std::size_t i = 0; i < samples; ++i) {
        auto const row = static_cast<Eigen::Index>(i);
        for (Eigen::Index k = 0; k < n; ++k) {
            out(row, k) = r.weight[i] / Complex{poles[static_cast<std::size_t>(k)], r.omega[i]};
        }
        out(row, n) = r.weight[i];
    }
    return out;
}

/// Of (1 + sum c / (s + p)) H = constant + sum r / (s + p): the c.
Eigen::VectorXd weights_of_poles(FrequencyResponse const& r, std::size_t exact, std::vector<double> const& poles) {
    auto const n = static_cast<Eigen::Index>(poles.size());
    Eigen::MatrixXcd const near = fractions(r, exact, poles);
    Eigen::MatrixXcd rows(near.rows(), 2 * n + 1);
    Eigen::VectorXcd right(near.rows());
    rows.leftCols(n + 1) = near;
    for (std::size_t i = 0; i < exact; ++i) {
        auto const row = static_cast<Eigen::Index>(i);
        rows.row(row).tail(n) = -r.value[i] * near.row(row).head(n);
        right[row] = r.weight[i] * r.value[i];
    }
    return solve_rows(rows, right).tail(n);
}

/// Residues and constant for given poles.
emt::PoleSum with_poles(FrequencyResponse const& r, std::size_t exact, std::vector<double> const& poles) {
    auto const n = static_cast<Eigen::Index>(poles.size());
    Eigen::MatrixXcd rows = fractions(r, r.omega.size(), poles);
    Eigen::VectorXcd right(rows.rows());
    for (std::size_t i = 0; i < r.omega.size(); ++i) {
        auto const row = static_cast<Eigen::Index>(i);
        double const more = i < exact ? 1 : kExactWeight;
        rows.row(row) *= more;
        right[row] = more * r.weight[i] * r.value[i];
    }
    Eigen::VectorXd const x = solve_rows(rows, right);
    return {x[n], poles, {x.data(), x.data() + n}};
}

} // namespace

emt::PoleSum vector_fit(FrequencyResponse const& r, std::size_t exact, int count, int rounds) {
    emt::PoleSum best = with_poles(r, exact, first_poles(r.omega, exact, count));
    double least = fit_error(r, exact, best);
    std::vector<double> poles = best.poles;
    for (int round = 0; round < rounds; ++round) {
        poles = moved(poles, weights_of_poles(r, exact, poles));
        emt::PoleSum fit = with_poles(r, exact, poles);
        if (double const error = fit_error(r, exact, fit); error < least) { // real poles need not get better each time
            least = error;
            best = std::move(fit);
        }
    }
    return best;
}

double fit_error(FrequencyResponse const& r, std::size_t count, emt::PoleSum const& fit) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        sum += std::norm(r.weight[i] * (fit.at({0, r.omega[i]}) - r.value[i]));
    }
    return std::sqrt(sum / static_cast<double>(count));
}

} // namespace gridspace::sim
