// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/three_phase.hpp"

#include "sim/powerflow/feeder.hpp"
#include "sim/powerflow/nodal_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim {

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
}

Result<ThreePhaseFlow> Feeder::iterate(ThreePhaseOptions const& options) {
    NodalNetwork network{nodes_, entries_, {}, held_, sources_, {}};
    for (auto const& [node, admittance] : linear_) {
        network.of_loads.emplace_back(node, node, admittance);
    }
    for (double const v : phase_v_) {
        network.base_v.insert(network.base_v.end(), 3, v);
    }
    auto const solution =
        solve_nodal(network, [this](Eigen::VectorXcd const& v, Eigen::VectorXcd& i) { currents(v, i); },
                    {options.tolerance_pu, options.max_iterations});
    if (!solution) {
        return std::unexpected{solution.error()};
    }
    ThreePhaseFlow out{solution->iterations, solution->change_pu, {}, {}};
    results(solution->v, out);
    return out;
}

void Feeder::results(Eigen::VectorXcd const& v, ThreePhaseFlow& out) const {
    for (std::size_t b = 0; b < n_.buses.size(); ++b) {
        auto const node = static_cast<int>(3 * b);
        out.buses.push_back({v[node], v[node + 1], v[node + 2]});
    }
    for (Series const& l : series_) {
        Eigen::Vector3cd const from = v.segment<3>(l.from), to = v.segment<3>(l.to);
        Eigen::Vector3cd const series = l.y * (from - to), i_from = series + l.shunt * from,
                               i_to = l.shunt * to - series;
        out.branches.push_back({l.element, {i_from[0], i_from[1], i_from[2]}, {i_to[0], i_to[1], i_to[2]}});
    }
    for (std::size_t t = 0; t < limbs_.size();) {
        ThreePhaseFlow::Branch branch{limbs_[t].element, {}, {}};
        int const from = node(two_ports_[branch.element]->from), to = node(two_ports_[branch.element]->to);
        for (; t < limbs_.size() && limbs_[t].element == branch.element; ++t) {
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
    NetworkAround const around{n};
    auto const at_one_bus = one_ports(n);
    auto const between_two = two_ports(n);
    return std::any_of(at_one_bus.begin(), at_one_bus.end(), [](OnePort const* e) { return e->unbalanced(); }) ||
           std::any_of(between_two.begin(), between_two.end(), [&](TwoPort const* e) { return e->unbalanced(around); });
}

Result<ThreePhaseFlow> solve_three_phase(Network const& network, SwitchState const& state,
                                         ThreePhaseOptions const& options) {
    return Feeder{network, state}.solve(options);
}

} // namespace gridspace::sim
