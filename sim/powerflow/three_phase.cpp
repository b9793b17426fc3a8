// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/three_phase.hpp"

#include "sim/powerflow/feeder.hpp"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {
namespace {

/// What nothing connects to earth still needs a potential: an earth connection of this share of a node's own
/// admittance.
constexpr double kAnchorShare = 1e-10;

} // namespace

template <class Shares>
void Feeder::add_loads(Shares shares) {
    linear_.clear();
    for (DrawnPower const& l : loads_) {
        auto const [p, q] = shares(*l.load);
        for (int k = 0; k < 3; ++k) {
            Complex const s = l.nominal(k);
            Complex const y = std::conj(Complex{s.real() * p, s.imag() * q}) / (l.rated_v * l.rated_v);
            if (y != Complex{}) {
                linear_.emplace_back(l.node + k, y);
            }
        }
    }
}

Result<ThreePhaseFlow> Feeder::solve(ThreePhaseOptions const& options) {
    hours_ = options.hours;
    start_hour_of_day_ = options.start_hour_of_day;
    if (auto ok = build(); !ok) {
        return std::unexpected{ok.error()};
    }
    // The share of a load that is an impedance belongs to the matrix: behind windings without earth it is all that
    // holds the potential. Where that does not lead to a solution, the whole load at nominal voltage may.
    add_loads([](VoltageDependent const& l) { return l.impedance_shares(); });
    auto flow = iterate(options);
    if (!flow) {
        add_loads([](VoltageDependent const&) { return std::pair{1.0, 1.0}; });
        auto again = iterate(options);
        return again ? again : flow;
    }
    return flow;
}

/// Currents of loads and converters at these voltages.
void Feeder::currents(Eigen::VectorXcd const& v, Eigen::VectorXcd& i) const {
    auto const consume = [&](int node, Complex power_va) {
        if (std::abs(v[node]) > 0) {
            i[node] -= std::conj(power_va / v[node]);
        }
    };
    // A converter: balanced currents that carry its power at the positive sequence voltage.
    auto const convert = [&](int node, Complex power_kva) {
        Complex const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
        Complex const v1 = (v[node] + turn * v[node + 1] + turn * turn * v[node + 2]) / 3.0;
        if (std::abs(v1) > 0) {
            Complex const current = std::conj(power_kva * 1e3 / 3.0 / v1);
            i[node] += current;
            i[node + 1] += current / turn;
            i[node + 2] += current * turn;
        }
    };
    for (DrawnPower const& l : loads_) {
        for (int k = 0; k < 3; ++k) {
            Complex const s = l.nominal(k);
            VoltagePower const f = l.load->factor(std::abs(v[l.node + k]) / l.rated_v);
            consume(l.node + k, {s.real() * f.p, s.imag() * f.q});
        }
    }
    for (auto const& [node, y] : linear_) { // the matrix has it
        i[node] += y * v[node];
    }
    for (auto const& [node, kva] : converters_) {
        convert(node, kva);
    }
    for (Generator const& g : n_.generators) {
        if (g.role == GeneratorRole::pq) {
            convert(node_of(g.bus), {g.p_kw, g.q_kvar});
        }
    }
}

Result<ThreePhaseFlow> Feeder::iterate(ThreePhaseOptions const& options) {
    std::vector<Eigen::Triplet<Complex>> places;
    std::vector<double> own(static_cast<std::size_t>(nodes_), 0.0);
    for (auto const& e : entries_) {
        if (!held_.contains(e.row())) {
            places.push_back(e);
            own[static_cast<std::size_t>(e.row())] += e.row() == e.col() ? std::abs(e.value()) : 0;
        }
    }
    for (auto const& [node, admittance] : linear_) {
        if (!held_.contains(node)) {
            places.emplace_back(node, node, admittance);
        }
    }
    for (int k = 0; k < nodes_; ++k) {
        places.emplace_back(k, k, held_.contains(k) ? 1 : kAnchorShare * own[static_cast<std::size_t>(k)]);
    }
    Eigen::SparseMatrix<Complex> y(nodes_, nodes_);
    y.setFromTriplets(places.begin(), places.end());
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors{y};
    if (factors.info() != Eigen::Success) {
        return fail(ExitCode::usage, "the three-phase admittance matrix is singular",
                    "is a part of the network without any element?");
    }
    Eigen::VectorXcd driven = Eigen::VectorXcd::Zero(nodes_);
    for (auto const& [node, current] : sources_) {
        driven[node] += current;
    }
    auto const hold = [&](Eigen::VectorXcd& rhs) {
        for (auto const& [node, voltage] : held_) {
            rhs[node] = voltage;
        }
    };
    hold(driven);
    Eigen::VectorXcd v = factors.solve(driven);
    ThreePhaseFlow out;
    for (out.iterations = 1; out.iterations <= options.max_iterations; ++out.iterations) {
        Eigen::VectorXcd i = driven;
        currents(v, i);
        hold(i);
        Eigen::VectorXcd const next = factors.solve(i);
        out.change_pu = 0;
        for (std::size_t b = 0; b < n_.buses.size(); ++b) {
            for (int k = 0; k < 3; ++k) {
                auto const node = static_cast<int>(3 * b) + k;
                out.change_pu = std::max(out.change_pu, std::abs(next[node] - v[node]) / phase_v_[b]);
            }
        }
        v = next;
        if (!(out.change_pu < 1e3)) {
            break;
        }
        if (out.change_pu < options.tolerance_pu) {
            results(v, out);
            return out;
        }
    }
    return fail(
        ExitCode::usage,
        fmt::format("the three-phase power flow does not converge: voltages still move by {:.3g} p.u.", out.change_pu),
        "the loads are more than the network can carry, an impedance is wrong, or loads of constant power lie "
        "behind windings that nothing connects to earth");
}

void Feeder::results(Eigen::VectorXcd const& v, ThreePhaseFlow& out) const {
    for (std::size_t b = 0; b < n_.buses.size(); ++b) {
        auto const node = static_cast<int>(3 * b);
        out.buses.push_back({v[node], v[node + 1], v[node + 2]});
    }
    for (LineParts const& l : lines_) {
        Eigen::Vector3cd const from = v.segment<3>(l.from), to = v.segment<3>(l.to);
        Eigen::Vector3cd const series = l.y * (from - to), i_from = series + l.shunt * from,
                               i_to = l.shunt * to - series;
        out.branches.push_back(
            {TwoPort::Kind::line, l.index, {i_from[0], i_from[1], i_from[2]}, {i_to[0], i_to[1], i_to[2]}});
    }
    for (std::size_t t = 0; t < limbs_.size();) {
        ThreePhaseFlow::Branch branch{TwoPort::Kind::transformer, limbs_[t].index, {}, {}};
        int const from = node_of(n_.transformers[branch.element].from),
                  to = node_of(n_.transformers[branch.element].to);
        for (; t < limbs_.size() && limbs_[t].index == branch.element; ++t) {
            Limb const& l = limbs_[t];
            Complex i{};
            for (std::size_t e = 0; e < 4; ++e) {
                i += l.nodes[e] < 0 ? Complex{} : l.y * l.weights[e] * v[l.nodes[e]];
            }
            for (std::size_t e = 0; e < 4; ++e) {
                int const node = l.nodes[e];
                if (node >= from && node < from + 3) {
                    branch.from[static_cast<std::size_t>(node - from)] += l.weights[e] * i;
                } else if (node >= to && node < to + 3) {
                    branch.to[static_cast<std::size_t>(node - to)] += l.weights[e] * i;
                }
            }
        }
        out.branches.push_back(branch);
    }
}

bool is_unbalanced(Network const& n) {
    std::vector<OnePort const*> const elements = one_ports(n);
    return std::any_of(elements.begin(), elements.end(), [](OnePort const* e) { return e->unbalanced(); }) ||
           std::any_of(n.line_types.begin(), n.line_types.end(),
                       [](LineType const& t) { return !t.phase_r_ohm_per_km.empty(); });
}

Result<ThreePhaseFlow> solve_three_phase(Network const& network, SwitchState const& state,
                                         ThreePhaseOptions const& options) {
    return Feeder{network, state}.solve(options);
}

} // namespace gridspace::sim
