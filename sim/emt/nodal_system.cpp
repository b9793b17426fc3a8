// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/nodal_system.hpp"

#include <algorithm>

namespace gridspace::sim::emt {
namespace {

/// Costs of a multiplication in a dense product (vectorised) and in a sparse solve (indexed), relative to each other:
/// measured.
constexpr double kDenseCost = 1, kSparseCost = 5;

PhaseMatrix map_sequences(PhaseMatrix const& r, PhaseMatrix const& l, double (*f)(double r, double l2h), double h) {
    return PhaseMatrix::sequence(f(r.one, 2 * l.one / h), f(r.zero(), 2 * l.zero() / h));
}

StepCoefficients::Coupled coupled_coefficients(CoupledBranch const& b, double h) {
    StepCoefficients::Coupled out;
    if (b.kind == CoupledBranch::Kind::capacitive) {
        out.g = combined(2 / h, b.c, 0.0, b.c);
        out.v_trapezoid = out.v_euler = combined(-1.0, out.g, 0.0, out.g);
        out.i_trapezoid = diagonal(-1.0, -1.0, -1.0);
        return out;
    }
    out.g = inverse(combined(1.0, b.r, 2 / h, b.l));
    out.v_trapezoid = out.g;
    out.i_trapezoid = product(out.g, combined(2 / h, b.l, -1.0, b.r));
    out.i_euler = product(out.g, combined(2 / h, b.l, 0.0, b.l));
    return out;
}

} // namespace

void fill_coefficients(Circuit const& c, double h, StepCoefficients& out) {
    out.h = h;
    auto const g = [](double r, double l2h) { return 1 / (r + l2h); };
    auto const trapezoid = [](double r, double l2h) { return (l2h - r) / (r + l2h); };
    auto const euler = [](double r, double l2h) { return l2h / (r + l2h); };
    out.rl_g.clear();
    out.rl_trapezoid.clear();
    out.rl_euler.clear();
    out.rl_stores.clear();
    for (RlBranch const& b : c.rl) {
        out.rl_g.push_back(map_sequences(b.r, b.l, g, h));
        out.rl_trapezoid.push_back(map_sequences(b.r, b.l, trapezoid, h));
        out.rl_euler.push_back(map_sequences(b.r, b.l, euler, h));
        out.rl_stores.push_back(b.l.one != 0 || b.l.mutual != 0 ? 1 : 0);
    }
    out.capacitor_g.clear();
    for (CapacitorBranch const& b : c.capacitors) {
        out.capacitor_g.push_back(PhaseMatrix::sequence(2 * b.c.one / h, 2 * b.c.zero() / h));
    }
    out.coupled.clear();
    for (CoupledBranch const& b : c.coupled) {
        out.coupled.push_back(coupled_coefficients(b, h));
    }
    out.winding_g.clear();
    out.winding_trapezoid.clear();
    out.winding_euler.clear();
    for (Winding const& w : c.windings) {
        double const l2h = 2 * w.l / h;
        out.winding_g.push_back(g(w.r, l2h));
        out.winding_trapezoid.push_back(trapezoid(w.r, l2h));
        out.winding_euler.push_back(euler(w.r, l2h));
    }
    out.marti.clear();
    for (MartiLine const& line : c.marti) {
        out.marti.emplace_back(line, h);
    }
}

Admittances<double> StepCoefficients::admittances(Circuit const& c, SwitchBits const& bits) const {
    Admittances<double> y;
    y.rl = rl_g;
    y.capacitors = capacitor_g;
    for (Coupled const& b : coupled) {
        y.coupled.push_back(b.g);
    }
    y.windings = winding_g;
    for (NortonPort const& p : c.norton) {
        y.norton.push_back(p.element->conductance(h));
    }
    for (BergeronLine const& b : c.bergeron) {
        y.bergeron.push_back(PhaseMatrix::sequence(1 / (b.z1 + b.r1 / 4), 1 / (b.z0 + b.r0 / 4)));
    }
    for (MartiStep const& line : marti) {
        y.marti.push_back(line.conductance());
    }
    for (std::size_t i = 0; i < c.cores.size(); ++i) {
        y.cores.push_back(h / (2 * (bits.segment[i] == 0 ? c.cores[i].l : c.cores[i].l_air)));
    }
    return y;
}

void NodalSystem::finish_parts(double* x) const {
    if (!update) {
        return;
    }
    std::array<double, Update::kMaxRank> seen{};
    for (std::size_t k = 0; k < update->rank; ++k) {
        for (auto const& [slot, weight] : update->columns[k]) {
            seen[k] += slot < topology.unknowns ? weight * x[slot] : 0;
        }
    }
    update->subtract(seen, x);
}

void NodalSystem::solve(double const* b, double* x) const {
    if (update) {
        update->base->solve(b, x);
        finish_parts(x);
        return;
    }
    auto const n = static_cast<std::size_t>(topology.unknowns);
    if (!dense) {
        factors.solve(b, x);
        return;
    }
    std::fill(x, x + n, 0.0);
    double const* column = inverse.data();
    for (std::size_t j = 0; j < n; ++j, column += n) {
        double const bj = b[j];
        for (std::size_t i = 0; i < n; ++i) {
            x[i] += column[i] * bj;
        }
    }
}

void NodalSystem::add_column(int slot, double value, double* x) const {
    auto const n = static_cast<std::size_t>(topology.unknowns);
    if (update) {
        update->base->add_column(slot, value, x);
        std::array<double, Update::kMaxRank> seen{};
        for (std::size_t k = 0; k < update->rank; ++k) {
            seen[k] = value * update->w[k * n + static_cast<std::size_t>(slot)];
        }
        update->subtract(seen, x);
        return;
    }
    double const* const column = inverse.data() + static_cast<std::size_t>(slot) * n;
    for (std::size_t i = 0; i < n; ++i) {
        x[i] += column[i] * value;
    }
}

Result<std::shared_ptr<NodalSystem>> make_system(Circuit const& c, SwitchBits const& bits,
                                                 StepCoefficients const& coefficients, int parts) {
    auto topology = make_topology(c, bits);
    if (!topology) {
        return std::unexpected{topology.error()};
    }
    auto system = std::make_shared<NodalSystem>();
    system->bits = bits;
    system->h = coefficients.h;
    system->topology = std::move(*topology);
    Topology const& t = system->topology;
    auto assembly = assemble(c, t, bits, coefficients.admittances(c, bits));
    std::function<Division(EliminationTree const&)> const in_parts = [&](EliminationTree const& tree) {
        return divide(tree, element_ties(c, t), parts);
    };
    system->anchored = system->factors.factor(t.unknowns, assembly.matrix, parts > 1 ? in_parts : nullptr);
    auto const n = static_cast<std::size_t>(t.unknowns);
    system->dense =
        kDenseCost * static_cast<double>(n * n) <= kSparseCost * static_cast<double>(system->factors.work());
    if (system->dense) {
        system->inverse.assign(n * n, 0.0);
        for (std::size_t j = 0; j < n; ++j) {
            system->inverse[j * n + j] = 1;
            system->factors.solve(system->inverse.data() + j * n);
        }
    }
    system->shares = make_shares(c, t, assembly.coupling, system->dense ? Division{} : system->factors.division());
    return system;
}

} // namespace gridspace::sim::emt
