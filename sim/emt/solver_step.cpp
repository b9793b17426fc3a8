// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// One step of the solver: history currents, one solution of the network, Norton elements corrected, currents.
namespace gridspace::sim::emt {

void Solver::source_voltages(double t) {
    constexpr double kHalfRoot3 = 0.86602540378443864676;
    double* v = state_.v.data() + system_->topology.earth();
    *v++ = 0;
    for (std::size_t s = 0; s < circuit_.sources.size(); ++s, v += 3) {
        VoltageSource const& source = circuit_.sources[s];
        double const phase =
            std::fmod(2 * std::numbers::pi * source.frequency_hz * (t - source_since_[s]), 2 * std::numbers::pi) +
            source_phase_[s];
        double const c = source.amplitude_v * std::cos(phase), d = source.amplitude_v * std::sin(phase);
        v[0] = c;
        v[1] = -c / 2 + kHalfRoot3 * d;
        v[2] = -c / 2 - kHalfRoot3 * d;
        for (VoltageSource::Harmonic const& h : source.harmonics) {
            for (int k = 0; k < 3; ++k) {
                v[k] += source.amplitude_v * h.amplitude *
                        std::cos(h.order * (phase - k * 2 * std::numbers::pi / 3) + h.angle_rad);
            }
        }
    }
}

void Solver::histories(double t_end, Rule rule, StepCoefficients const& c) {
    bool const trapezoid = rule == Rule::trapezoid;
    double* const rhs = rhs_.data();
    std::fill(rhs_.begin(), rhs_.end(), 0.0);
    {
        double const *v = state_.rl_v.data(), *i = state_.rl_i.data();
        double* history = rl_history_.data();
        int const *from = system_->rl_from.data(), *to = system_->rl_to.data();
        PhaseMatrix const* past = trapezoid ? c.rl_trapezoid.data() : c.rl_euler.data();
        PhaseMatrix const* g = c.rl_g.data();
        unsigned char const* stores = c.rl_stores.data();
        for (std::size_t b = 0; b < circuit_.rl.size();
             ++b, v += 3, i += 3, history += 3, from += 3, to += 3, ++past, ++g, ++stores) {
            if (*stores == 0) {
                continue;
            }
            double common = past->mutual * (i[0] + i[1] + i[2]);
            double one = 0;
            if (trapezoid) {
                common += g->mutual * (v[0] + v[1] + v[2]);
                one = g->one;
            }
            for (int k = 0; k < 3; ++k) {
                history[k] = past->one * i[k] + one * v[k] + common;
                rhs[from[k]] -= history[k];
                rhs[to[k]] += history[k];
            }
        }
    }
    for (std::size_t b = 0; b < circuit_.capacitors.size(); ++b) {
        PhaseMatrix const& g = c.capacitor_g[b];
        double const* v = state_.capacitor_v.data() + 3 * b;
        double const* i = state_.capacitor_i.data() + 3 * b;
        double const common = g.mutual * (v[0] + v[1] + v[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            double const history = -(g.one * v[k] + common) - (trapezoid ? i[k] : 0);
            capacitor_history_[3 * b + k] = history;
            rhs[system_->capacitor_from[3 * b + k]] -= history;
            rhs[system_->capacitor_to[3 * b + k]] += history;
        }
    }
    for (std::size_t b = 0; b < circuit_.coupled.size(); ++b) {
        StepCoefficients::Coupled const& past = c.coupled[b];
        Matrix3 const& of_v = trapezoid ? past.v_trapezoid : past.v_euler;
        Matrix3 const& of_i = trapezoid ? past.i_trapezoid : past.i_euler;
        double const* v = state_.coupled_v.data() + 3 * b;
        double const* i = state_.coupled_i.data() + 3 * b;
        for (std::size_t k = 0; k < 3; ++k) {
            double const history = of_v[k][0] * v[0] + of_v[k][1] * v[1] + of_v[k][2] * v[2] + of_i[k][0] * i[0] +
                                   of_i[k][1] * i[1] + of_i[k][2] * i[2];
            coupled_history_[3 * b + k] = history;
            rhs[system_->coupled_from[3 * b + k]] -= history;
            rhs[system_->coupled_to[3 * b + k]] += history;
        }
    }
    for (std::size_t w = 0; w < circuit_.windings.size(); ++w) {
        double const history = trapezoid
                                   ? c.winding_g[w] * state_.winding_v[w] + c.winding_trapezoid[w] * state_.winding_i[w]
                                   : c.winding_euler[w] * state_.winding_i[w];
        winding_history_[w] = history;
        for (std::size_t k = 0; k < 4; ++k) {
            rhs[system_->winding[4 * w + k]] -= circuit_.windings[w].weights[k] * history;
        }
    }
    for (std::size_t w = 0; w < circuit_.cores.size(); ++w) {
        SaturableCore const& core = circuit_.cores[w];
        int const segment = bits_.segment[w];
        double const l = segment == 0 ? core.l : core.l_air;
        // Beyond the knee the line does not start at the origin.
        double const offset = segment * core.knee * (1 / core.l - 1 / core.l_air) * (segment == 0 ? 0 : 1);
        double const history = offset + (state_.core_flux[w] + (trapezoid ? c.h / 2 * state_.core_v[w] : 0)) / l;
        core_history_[w] = history;
        for (std::size_t k = 0; k < 4; ++k) {
            rhs[system_->core[4 * w + k]] -= core.weights[k] * history;
        }
    }
    for (std::size_t w = 0; w < waves_.size(); ++w) {
        double* const history = wave_history_.data() + 6 * w;
        waves_[w].history(t_end, history);
        for (std::size_t k = 0; k < 3; ++k) {
            rhs[system_->bergeron_from[3 * w + k]] -= history[k];
            rhs[system_->bergeron_to[3 * w + k]] -= history[3 + k];
        }
    }
    for (std::size_t w = 0; w < marti_.size(); ++w) {
        double* const history = marti_history_.data() + 6 * w;
        marti_[w].history(c.marti[w], rule, t_end, history);
        for (std::size_t k = 0; k < 3; ++k) {
            rhs[system_->marti_from[3 * w + k]] -= history[k];
            rhs[system_->marti_to[3 * w + k]] -= history[3 + k];
        }
    }
    for (std::size_t k = 0; k < injected_.size(); ++k) {
        rhs[system_->injection[k]] += injected_[k];
    }
}

void Solver::currents(StepCoefficients const& c) {
    double const* const x = state_.v.data();
    {
        double *v = state_.rl_v.data(), *i = state_.rl_i.data();
        double const* history = rl_history_.data();
        int const *from = system_->rl_from.data(), *to = system_->rl_to.data();
        PhaseMatrix const* g = c.rl_g.data();
        for (std::size_t b = 0; b < circuit_.rl.size(); ++b, v += 3, i += 3, history += 3, from += 3, to += 3, ++g) {
            v[0] = x[from[0]] - x[to[0]];
            v[1] = x[from[1]] - x[to[1]];
            v[2] = x[from[2]] - x[to[2]];
            double const common = g->mutual * (v[0] + v[1] + v[2]);
            for (int k = 0; k < 3; ++k) {
                i[k] = g->one * v[k] + common + history[k];
            }
        }
    }
    for (std::size_t b = 0; b < circuit_.capacitors.size(); ++b) {
        PhaseMatrix const& g = c.capacitor_g[b];
        double* const v = state_.capacitor_v.data() + 3 * b;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = x[system_->capacitor_from[3 * b + k]] - x[system_->capacitor_to[3 * b + k]];
        }
        double const common = g.mutual * (v[0] + v[1] + v[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            state_.capacitor_i[3 * b + k] = g.one * v[k] + common + capacitor_history_[3 * b + k];
        }
    }
    for (std::size_t b = 0; b < circuit_.coupled.size(); ++b) {
        Matrix3 const& g = c.coupled[b].g;
        double* const v = state_.coupled_v.data() + 3 * b;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = x[system_->coupled_from[3 * b + k]] - x[system_->coupled_to[3 * b + k]];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            state_.coupled_i[3 * b + k] =
                g[k][0] * v[0] + g[k][1] * v[1] + g[k][2] * v[2] + coupled_history_[3 * b + k];
        }
    }
    for (std::size_t w = 0; w < circuit_.windings.size(); ++w) {
        double v = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            v += circuit_.windings[w].weights[k] * x[system_->winding[4 * w + k]];
        }
        state_.winding_v[w] = v;
        state_.winding_i[w] = c.winding_g[w] * v + winding_history_[w];
    }
}

void Solver::waves(double t_end, Rule rule, StepCoefficients const& c) {
    double const* const x = state_.v.data();
    auto const at_ends = [&](std::vector<int> const& from, std::vector<int> const& to, std::size_t line) {
        std::array<double, 6> v;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = x[from[3 * line + k]];
            v[3 + k] = x[to[3 * line + k]];
        }
        return v;
    };
    auto const set_currents = [](PhaseMatrix const& g, std::array<double, 6> const& v, double const* history,
                                 double* i) {
        for (std::size_t end = 0; end < 2; ++end) {
            double const common = g.mutual * (v[3 * end] + v[3 * end + 1] + v[3 * end + 2]);
            for (std::size_t k = 3 * end; k < 3 * end + 3; ++k) {
                i[k] = g.one * v[k] + common + history[k];
            }
        }
    };
    for (std::size_t w = 0; w < waves_.size(); ++w) {
        auto const v = at_ends(system_->bergeron_from, system_->bergeron_to, w);
        double* const i = state_.wave_i.data() + 6 * w;
        set_currents(waves_[w].conductance(), v, wave_history_.data() + 6 * w, i);
        waves_[w].leave(t_end, v.data(), i);
    }
    for (std::size_t w = 0; w < marti_.size(); ++w) {
        auto const v = at_ends(system_->marti_from, system_->marti_to, w);
        double* const i = state_.marti_i.data() + 6 * w;
        set_currents(c.marti[w].conductance(), v, marti_history_.data() + 6 * w, i);
        marti_[w].leave(c.marti[w], rule, t_end, v.data(), i);
    }
}

void Solver::solve_network() {
    system_->solve(rhs_.data(), state_.v.data());
}

void Solver::substep(double t_end, double h, Rule rule, StepCoefficients const& c) {
    histories(t_end, rule, c);
    double* const x = state_.v.data();
    double* const rhs = rhs_.data();
    source_voltages(t_end);
    for (Entry<double> const& e : system_->coupling) {
        rhs[e.row] -= e.value * x[e.column];
    }
    int corrections = 0;
    int const* slot = system_->norton.data();
    for (NortonPort const& p : circuit_.norton) {
        auto const j = p.element->predict(t_end, h, rule);
        for (std::size_t k = 0; k < 3; ++k) {
            rhs[slot[k]] += j[k];
        }
        slot += 3;
        corrections = std::max(corrections, p.element->corrections());
    }
    solve_network();
    for (int repeat = corrections; repeat > 0; --repeat) {
        slot = system_->norton.data();
        int const unknowns = system_->topology.unknowns;
        double* const change = correction_.data();
        std::size_t changes = 0;
        for (NortonPort const& p : circuit_.norton) {
            double const v[3] = {x[slot[0]], x[slot[1]], x[slot[2]]};
            auto const j = p.element->correct(v);
            for (std::size_t k = 0; k < 3; ++k) {
                change[changes++] = j[k];
            }
            slot += 3;
        }
        for (std::size_t k = 0; k < changes; ++k) {
            int const s = system_->norton[k];
            if (s >= unknowns) {
                continue;
            }
            if (system_->dense) {
                system_->add_column(s, change[k], x);
            } else {
                rhs[s] += change[k];
            }
        }
        if (!system_->dense) {
            solve_network();
        }
    }
    slot = system_->norton.data();
    for (NortonPort const& p : circuit_.norton) {
        double const v[3] = {x[slot[0]], x[slot[1]], x[slot[2]]};
        p.element->finish(v);
        slot += 3;
    }
    currents(c);
    waves(t_end, rule, c);
    double const half = c.h / 2; // of the trapezoid, or a whole backward Euler step: both weigh the new voltage alike
    for (std::size_t w = 0; w < circuit_.cores.size(); ++w) {
        double v = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            v += circuit_.cores[w].weights[k] * x[system_->core[4 * w + k]];
        }
        state_.core_flux[w] += half * (v + (rule == Rule::trapezoid ? state_.core_v[w] : 0));
        state_.core_v[w] = v;
        double const l = bits_.segment[w] == 0 ? circuit_.cores[w].l : circuit_.cores[w].l_air;
        state_.core_i[w] = half / l * v + core_history_[w];
    }
}

} // namespace gridspace::sim::emt
