// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/problem.hpp"

#include "sim/powerflow/sparse_lu.hpp"

#include <Eigen/SparseCore>
#include <cmath>
#include <limits>

namespace gridspace::sim {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Powers next to a very small impedance are differences of large numbers; no iteration brings them nearer than this
/// share.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

/// AdmittanceRow-wise admittance matrix.
struct AdmittanceRow {
    std::vector<std::pair<std::size_t, Complex>> entries;
};

std::vector<AdmittanceRow> admittance(PowerFlowProblem const& problem) {
    std::vector<AdmittanceRow> rows(problem.nodes.size());
    auto const add = [&](std::size_t r, std::size_t c, Complex y) {
        for (auto& [column, value] : rows[r].entries) {
            if (column == c) {
                value += y;
                return;
            }
        }
        rows[r].entries.emplace_back(c, y);
    };
    for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
        add(i, i, problem.shunts[i]);
    }
    for (Branch const& b : problem.branches) {
        add(b.from, b.from, b.ff);
        add(b.from, b.to, b.ft);
        add(b.to, b.from, b.tf);
        add(b.to, b.to, b.tt);
    }
    return rows;
}

class Solver {
  public:
    Solver(PowerFlowProblem const& problem, PowerFlowOptions const& options, double scale, PowerFlowStart const* start)
        : problem_{problem}, options_{options}, scale_{scale}, y_{admittance(problem)}, kind_(problem.nodes.size()),
          held_q_(problem.nodes.size()) {
        for (std::size_t i = 0; i < problem.nodes.size(); ++i) {
            kind_[i] = problem.nodes[i].kind;
            held_q_[i] = problem.nodes[i].q;
            out_.v.push_back(start != nullptr ? start->v[i] : problem.nodes[i].v);
            out_.angle.push_back(start != nullptr ? start->angle[i] : problem.nodes[i].angle);
        }
    }

    NewtonOutcome run() {
        iterate();
        // Generators beyond their limits become PQ at the limit; repeat until none changes.
        for (int round = 0; options_.enforce_q_limits && out_.converged && round < 20 && clamp_generators(); ++round) {
            iterate();
        }
        return out_;
    }

  private:
    void iterate() {
        number_unknowns();
        analysed_ = false;
        out_.converged = false;
        for (int i = 0; i <= options_.max_iterations; ++i) {
            mismatches();
            out_.iterations = i;
            if (!excess_) {
                out_.converged = true;
                return;
            }
            if (!std::isfinite(out_.mismatch) || out_.mismatch > 1e12 || i == options_.max_iterations || !step()) {
                return;
            }
        }
    }

    void number_unknowns() {
        angle_index_.assign(kind_.size(), kNone);
        v_index_.assign(kind_.size(), kNone);
        unknowns_ = 0;
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            if (kind_[i] == NodeKind::pv || kind_[i] == NodeKind::pq) {
                angle_index_[i] = unknowns_++;
            }
        }
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            if (kind_[i] == NodeKind::pq) {
                v_index_[i] = unknowns_++;
            }
        }
    }

    /// Computed injection minus specified, per unknown.
    void mismatches() {
        std::size_t const n = kind_.size();
        phasor_.resize(n);
        for (std::size_t i = 0; i < n; ++i) {
            phasor_[i] = std::polar(out_.v[i], out_.angle[i]);
        }
        out_.injection.assign(n, Complex{});
        rounding_.assign(n, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            Complex current{};
            double sizes = 0;
            for (auto const& [j, y] : y_[i].entries) {
                current += y * phasor_[j];
                sizes += std::abs(y) * out_.v[j];
            }
            out_.injection[i] = phasor_[i] * std::conj(current);
            rounding_[i] = kRounding * sizes * out_.v[i];
        }
        slopes_.assign(n, {});
        specified_.assign(n, Complex{});
        for (std::size_t i = 0; i < n; ++i) {
            specified_[i] = scale_ * Complex{problem_.nodes[i].p, held_q_[i]};
        }
        for (PowerFlowProblem::BusLoad const& load : problem_.loads) {
            VoltagePower const f =
                load.load->factor(out_.v[load.node], 0); // the model as it is, even when it has no solution
            specified_[load.node] -= scale_ * Complex{load.p * f.p, load.q * f.q};
            slopes_[load.node].first += scale_ * load.p * f.dp_dv;
            slopes_[load.node].second += scale_ * load.q * f.dq_dv;
        }
        rhs_.resize(static_cast<Eigen::Index>(unknowns_));
        out_.mismatch = 0;
        excess_ = false;
        for (std::size_t i = 0; i < n; ++i) {
            Complex const difference = out_.injection[i] - specified_[i];
            auto const enter = [&](std::size_t at, double value) {
                if (at == kNone) {
                    return;
                }
                rhs_[static_cast<Eigen::Index>(at)] = value;
                if (!(std::abs(value) <= std::max(options_.tolerance_pu, rounding_[i]))) {
                    excess_ = true;
                }
                if (!(std::abs(value) <= out_.mismatch)) { // a NaN is the worst
                    out_.mismatch = std::abs(value);
                    out_.worst_node = i;
                }
            };
            enter(angle_index_[i], difference.real());
            enter(v_index_[i], difference.imag());
        }
    }

    /// One Newton step; false when the Jacobian is singular.
    bool step() {
        triplets_.clear();
        auto const add = [&](std::size_t r, std::size_t c, double value) {
            if (r != kNone && c != kNone) {
                triplets_.emplace_back(static_cast<int>(r), static_cast<int>(c), value);
            }
        };
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            if (angle_index_[i] == kNone) {
                continue;
            }
            double const vi = out_.v[i];
            for (auto const& [j, y] : y_[i].entries) {
                if (j == i) {
                    continue;
                }
                // S_ij = V_i conj(y_ij V_j); dS/d(angle_j) = -j S_ij, dS/d|V_j| = S_ij / |V_j|
                Complex const s = phasor_[i] * std::conj(y * phasor_[j]);
                add(angle_index_[i], angle_index_[j], s.imag());
                add(angle_index_[i], v_index_[j], s.real() / out_.v[j]);
                add(v_index_[i], angle_index_[j], -s.real());
                add(v_index_[i], v_index_[j], s.imag() / out_.v[j]);
            }
            Complex own{};
            for (auto const& [j, y] : y_[i].entries) {
                own = j == i ? y : own;
            }
            Complex const s = out_.injection[i];
            double const g = own.real() * vi * vi, b = own.imag() * vi * vi;
            add(angle_index_[i], angle_index_[i], -s.imag() - b);
            add(angle_index_[i], v_index_[i], (s.real() + g) / vi + slopes_[i].first);
            add(v_index_[i], angle_index_[i], s.real() - g);
            add(v_index_[i], v_index_[i], (s.imag() - b) / vi + slopes_[i].second);
        }
        auto const size = static_cast<Eigen::Index>(unknowns_);
        Sparse jacobian(size, size);
        jacobian.setFromTriplets(triplets_.begin(), triplets_.end());
        jacobian.makeCompressed();
        if (!analysed_) { // its pattern stays
            lu_.analyzePattern(jacobian);
            analysed_ = true;
        }
        lu_.factorize(jacobian);
        if (lu_.info() != Eigen::Success) {
            out_.singular = true;
            return false;
        }
        Eigen::VectorXd const change = lu_.solve(rhs_);
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            if (angle_index_[i] != kNone) {
                out_.angle[i] -= change[static_cast<Eigen::Index>(angle_index_[i])];
            }
            if (v_index_[i] != kNone) {
                // A step through zero voltage has no meaning; the next one corrects.
                double const dv = change[static_cast<Eigen::Index>(v_index_[i])];
                out_.v[i] = std::max(out_.v[i] - dv, 0.2 * out_.v[i]);
            }
        }
        return true;
    }

    bool clamp_generators() {
        bool changed = false;
        for (std::size_t i = 0; i < kind_.size(); ++i) {
            if (kind_[i] != NodeKind::pv) {
                continue;
            }
            // The limits are those of the generators alone, not of what else injects at their bus.
            double const generated = out_.injection[i].imag() - specified_[i].imag();
            double const limited = std::min(std::max(generated, problem_.nodes[i].q_min), problem_.nodes[i].q_max);
            if (limited != generated) {
                kind_[i] = NodeKind::pq;
                held_q_[i] = problem_.nodes[i].q + limited;
                changed = true;
            }
        }
        return changed;
    }

    PowerFlowProblem const& problem_;
    PowerFlowOptions const& options_;
    double scale_;
    std::vector<AdmittanceRow> y_;
    std::vector<NodeKind> kind_;
    std::vector<double> held_q_;
    NewtonOutcome out_;
    std::vector<std::size_t> angle_index_, v_index_;
    std::size_t unknowns_{0};
    std::vector<Complex> phasor_, specified_;
    std::vector<double> rounding_; ///< by node: what of its power is rounding error, p.u.
    bool excess_{false};           ///< a mismatch is larger than tolerance and rounding
    std::vector<std::pair<double, double>> slopes_;
    std::vector<Triplet> triplets_;
    Eigen::VectorXd rhs_;
    Eigen::SparseLU<Sparse> lu_;
    bool analysed_{false};
};

} // namespace

NewtonOutcome newton(PowerFlowProblem const& problem, PowerFlowOptions const& options, double scale,
                     PowerFlowStart const* start) {
    return Solver{problem, options, scale, start}.run();
}

} // namespace gridspace::sim
