// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <algorithm>
#include <array>

/// What elements carry over from the step before, and the right-hand sides that it makes.
namespace gridspace::sim::emt {
namespace {

void rl_trapezoid(PhaseMatrix const& g, PhaseMatrix const& past, double const* v, double const* i, double* h) {
    double common = past.mutual * (i[0] + i[1] + i[2]);
    common += g.mutual * (v[0] + v[1] + v[2]);
    for (int k = 0; k < 3; ++k) {
        h[k] = past.one * i[k] + g.one * v[k] + common;
    }
}

void rl_euler(PhaseMatrix const& past, double const* v, double const* i, double* h) {
    double const common = past.mutual * (i[0] + i[1] + i[2]);
    for (int k = 0; k < 3; ++k) {
        h[k] = past.one * i[k] + 0.0 * v[k] + common;
    }
}

/// Histories of branches of equal phases, by `history(branch, v, i, out)`, which says whether it has one, and what they
/// add to the right-hand side.
template <class History>
void add_histories(Share::Branches const& branches, double const* all_v, double const* all_i, double* all_histories,
                   double* rhs, History const& history) {
    int const *from = branches.from.data(), *to = branches.to.data();
    unsigned char const* shunt = branches.shunt.data();
    for (int const index : branches.index) {
        auto const b = static_cast<std::size_t>(index);
        double h[3];
        if (history(b, all_v + 3 * b, all_i + 3 * b, h)) {
            double* const out = all_histories + 3 * b;
            out[0] = h[0];
            out[1] = h[1];
            out[2] = h[2];
            if (*shunt != 0) {
                double* const r = rhs + from[0];
                double const r0 = r[0] - h[0], r1 = r[1] - h[1], r2 = r[2] - h[2];
                r[0] = r0;
                r[1] = r1;
                r[2] = r2;
            } else {
                for (int k = 0; k < 3; ++k) {
                    rhs[from[k]] -= h[k];
                    rhs[to[k]] += h[k];
                }
            }
        }
        from += 3;
        to += 3;
        ++shunt;
    }
}

/// Of the ends of travelling-wave lines, by `history(end, out)`.
template <class History>
void end_histories(Share::Terminals const& ends, double* all_histories, double* rhs, History const& history) {
    int const* slot = ends.slots.data();
    for (int const index : ends.index) {
        auto const end = static_cast<std::size_t>(index);
        double* const h = all_histories + 3 * end;
        history(end, h);
        for (int k = 0; k < 3; ++k) {
            rhs[slot[k]] -= h[k];
        }
        slot += 3;
    }
}

} // namespace

void Solver::histories(std::size_t which, double t_end, Rule rule, StepCoefficients const& c) {
    bool const trapezoid = rule == Rule::trapezoid;
    Share const& share = system_->shares.parts[which];
    double* const rhs = rhs_[which].data();
    std::fill_n(rhs, system_->topology.places(), 0.0);
    if (trapezoid) {
        add_histories(share.rl, state_.rl_v.data(), state_.rl_i.data(), rl_history_.data(), rhs,
                      [stores = c.rl_stores.data(), g = c.rl_g.data(),
                       past = c.rl_trapezoid.data()](std::size_t b, double const* v, double const* i, double* h) {
                          return stores[b] != 0 && (rl_trapezoid(g[b], past[b], v, i, h), true);
                      });
        add_histories(share.capacitors, state_.capacitor_v.data(), state_.capacitor_i.data(), capacitor_history_.data(),
                      rhs, [g = c.capacitor_g.data()](std::size_t b, double const* v, double const* i, double* h) {
                          double const common = g[b].mutual * (v[0] + v[1] + v[2]);
                          for (int k = 0; k < 3; ++k) {
                              h[k] = -(g[b].one * v[k] + common) - i[k];
                          }
                          return true;
                      });
    } else {
        add_histories(share.rl, state_.rl_v.data(), state_.rl_i.data(), rl_history_.data(), rhs,
                      [stores = c.rl_stores.data(), past = c.rl_euler.data()](std::size_t b, double const* v,
                                                                              double const* i, double* h) {
                          return stores[b] != 0 && (rl_euler(past[b], v, i, h), true);
                      });
        add_histories(share.capacitors, state_.capacitor_v.data(), state_.capacitor_i.data(), capacitor_history_.data(),
                      rhs, [g = c.capacitor_g.data()](std::size_t b, double const* v, double const*, double* h) {
                          double const common = g[b].mutual * (v[0] + v[1] + v[2]);
                          for (int k = 0; k < 3; ++k) {
                              h[k] = -(g[b].one * v[k] + common) - 0.0;
                          }
                          return true;
                      });
    }
    for (std::size_t n = 0; n < share.coupled.index.size(); ++n) {
        auto const b = static_cast<std::size_t>(share.coupled.index[n]);
        StepCoefficients::Coupled const& past = c.coupled[b];
        Matrix3 const& of_v = trapezoid ? past.v_trapezoid : past.v_euler;
        Matrix3 const& of_i = trapezoid ? past.i_trapezoid : past.i_euler;
        double const* v = state_.coupled_v.data() + 3 * b;
        double const* i = state_.coupled_i.data() + 3 * b;
        for (std::size_t k = 0; k < 3; ++k) {
            double const history = of_v[k][0] * v[0] + of_v[k][1] * v[1] + of_v[k][2] * v[2] + of_i[k][0] * i[0] +
                                   of_i[k][1] * i[1] + of_i[k][2] * i[2];
            coupled_history_[3 * b + k] = history;
            rhs[share.coupled.from[3 * n + k]] -= history;
            rhs[share.coupled.to[3 * n + k]] += history;
        }
    }
    for (std::size_t n = 0; n < share.windings.index.size(); ++n) {
        auto const w = static_cast<std::size_t>(share.windings.index[n]);
        double const history = trapezoid
                                   ? c.winding_g[w] * state_.winding_v[w] + c.winding_trapezoid[w] * state_.winding_i[w]
                                   : c.winding_euler[w] * state_.winding_i[w];
        winding_history_[w] = history;
        for (std::size_t k = 0; k < 4; ++k) {
            rhs[share.windings.slots[4 * n + k]] -= circuit_.windings[w].weights[k] * history;
        }
    }
    for (std::size_t n = 0; n < share.cores.index.size(); ++n) {
        auto const w = static_cast<std::size_t>(share.cores.index[n]);
        SaturableCore const& core = circuit_.cores[w];
        int const segment = bits_.segment[w];
        double const l = segment == 0 ? core.l : core.l_air;
        // Beyond the knee the line does not start at the origin.
        double const offset = segment * core.knee * (1 / core.l - 1 / core.l_air) * (segment == 0 ? 0 : 1);
        double const history = offset + (state_.core_flux[w] + (trapezoid ? c.h / 2 * state_.core_v[w] : 0)) / l;
        core_history_[w] = history;
        for (std::size_t k = 0; k < 4; ++k) {
            rhs[share.cores.slots[4 * n + k]] -= core.weights[k] * history;
        }
    }
    end_histories(share.wave_ends, wave_history_.data(), rhs,
                  [&](std::size_t end, double* history) { waves_[end / 2].history(t_end, end % 2, history); });
    end_histories(share.marti_ends, marti_history_.data(), rhs, [&](std::size_t end, double* history) {
        marti_[end / 2].history(c.marti[end / 2], rule, t_end, end % 2, history);
    });
    int const* slot = share.injections.slots.data();
    for (int const index : share.injections.index) {
        double const* const i = injected_.data() + 3 * index;
        for (int k = 0; k < 3; ++k) {
            rhs[slot[k]] += i[k];
        }
        slot += 3;
    }
    for (Entry<double> const& e : share.coupling) {
        rhs[e.row] -= e.value * state_.v[static_cast<std::size_t>(e.column)];
    }
}

/// What elements of the shares, and of none, add to the rows of none, in the order of the circuit.
void Solver::fill_rest() {
    if (!system_->divided()) {
        return;
    }
    std::array<double const*, kHistoryKinds> const from{
        rl_history_.data(),   capacitor_history_.data(), coupled_history_.data(), winding_history_.data(),
        core_history_.data(), wave_history_.data(),      marti_history_.data(),   injected_.data(),
        state_.v.data(),      norton_i_.data()};
    double* const rhs = rhs_.back().data();
    std::fill_n(rhs, system_->topology.places(), 0.0);
    for (RestEntry const& e : system_->shares.rest) {
        rhs[e.row] += e.factor * from[static_cast<std::size_t>(e.kind)][e.at];
    }
}

} // namespace gridspace::sim::emt
