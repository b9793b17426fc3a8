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

namespace {

/// Voltages and currents of branches of equal phases.
void branch_currents(Share::Branches const& branches, PhaseMatrix const* all_g, double const* x,
                     double const* all_histories, double* all_v, double* all_i) {
    int const *from = branches.from.data(), *to = branches.to.data();
    unsigned char const* shunt = branches.shunt.data();
    for (int const index : branches.index) {
        auto const b = static_cast<std::size_t>(index);
        double *const v = all_v + 3 * b, *const i = all_i + 3 * b;
        double const* const history = all_histories + 3 * b;
        PhaseMatrix const g = all_g[b];
        double v0, v1, v2;
        if (*shunt++ != 0) {
            double const* const at = x + from[0];
            v0 = at[0];
            v1 = at[1];
            v2 = at[2];
        } else {
            v0 = x[from[0]] - x[to[0]];
            v1 = x[from[1]] - x[to[1]];
            v2 = x[from[2]] - x[to[2]];
        }
        double const common = g.mutual * (v0 + v1 + v2);
        i[0] = g.one * v0 + common + history[0];
        i[1] = g.one * v1 + common + history[1];
        i[2] = g.one * v2 + common + history[2];
        v[0] = v0;
        v[1] = v1;
        v[2] = v2;
        from += 3;
        to += 3;
    }
}

} // namespace

void Solver::currents(Share const& share, StepCoefficients const& c) {
    double const* const x = state_.v.data();
    branch_currents(share.rl, c.rl_g.data(), x, rl_history_.data(), state_.rl_v.data(), state_.rl_i.data());
    branch_currents(share.capacitors, c.capacitor_g.data(), x, capacitor_history_.data(), state_.capacitor_v.data(),
                    state_.capacitor_i.data());
    for (std::size_t n = 0; n < share.coupled.index.size(); ++n) {
        auto const b = static_cast<std::size_t>(share.coupled.index[n]);
        Matrix3 const& g = c.coupled[b].g;
        double* const v = state_.coupled_v.data() + 3 * b;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = x[share.coupled.from[3 * n + k]] - x[share.coupled.to[3 * n + k]];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            state_.coupled_i[3 * b + k] =
                g[k][0] * v[0] + g[k][1] * v[1] + g[k][2] * v[2] + coupled_history_[3 * b + k];
        }
    }
    for (std::size_t n = 0; n < share.windings.index.size(); ++n) {
        auto const w = static_cast<std::size_t>(share.windings.index[n]);
        double v = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            v += circuit_.windings[w].weights[k] * x[share.windings.slots[4 * n + k]];
        }
        state_.winding_v[w] = v;
        state_.winding_i[w] = c.winding_g[w] * v + winding_history_[w];
    }
}

namespace {

/// Of the ends of lines in a share: voltages and currents, which `leave` takes.
template <class Conductance, class Leave>
void end_currents(Share::Terminals const& ends, double const* x, double const* histories, double* all_i,
                  Conductance const& conductance, Leave const& leave) {
    for (std::size_t n = 0; n < ends.index.size(); ++n) {
        auto const end = static_cast<std::size_t>(ends.index[n]);
        std::array<double, 3> v{};
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = x[ends.slots[3 * n + k]];
        }
        PhaseMatrix const g = conductance(end / 2);
        double const common = g.mutual * (v[0] + v[1] + v[2]);
        double* const i = all_i + 3 * end;
        for (std::size_t k = 0; k < 3; ++k) {
            i[k] = g.one * v[k] + common + histories[3 * end + k];
        }
        leave(end, v.data(), i);
    }
}

} // namespace

void Solver::waves(Share const& share, Rule rule, StepCoefficients const& c) {
    double const* const x = state_.v.data();
    end_currents(
        share.wave_ends, x, wave_history_.data(), state_.wave_i.data(),
        [&](std::size_t line) { return waves_[line].conductance(); },
        [&](std::size_t end, double const* v, double const* i) { waves_[end / 2].leave(end % 2, v, i); });
    end_currents(
        share.marti_ends, x, marti_history_.data(), state_.marti_i.data(),
        [&](std::size_t line) { return c.marti[line].conductance(); },
        [&](std::size_t end, double const* v, double const* i) {
            marti_[end / 2].leave(c.marti[end / 2], rule, end % 2, v, i);
        });
}

void Solver::cores(Share const& share, Rule rule, StepCoefficients const& c) {
    double const half = c.h / 2; // of the trapezoid, or a whole backward Euler step: both weigh the new voltage alike
    for (std::size_t n = 0; n < share.cores.index.size(); ++n) {
        auto const w = static_cast<std::size_t>(share.cores.index[n]);
        double v = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            v += circuit_.cores[w].weights[k] * state_.v[static_cast<std::size_t>(share.cores.slots[4 * n + k])];
        }
        state_.core_flux[w] += half * (v + (rule == Rule::trapezoid ? state_.core_v[w] : 0));
        state_.core_v[w] = v;
        double const l = bits_.segment[w] == 0 ? circuit_.cores[w].l : circuit_.cores[w].l_air;
        state_.core_i[w] = half / l * v + core_history_[w];
    }
}

void Solver::predict(std::size_t which, double t_end, double h, Rule rule) {
    Share::Terminals const& norton = system_->shares.parts[which].norton;
    double* const rhs = rhs_[which].data();
    int const* slot = norton.slots.data();
    for (int const m : norton.index) {
        auto const j = circuit_.norton[static_cast<std::size_t>(m)].element->predict(t_end, h, rule);
        double* const kept = norton_i_.data() + 3 * m;
        for (std::size_t k = 0; k < 3; ++k) {
            kept[k] = j[k];
            rhs[slot[k]] += j[k];
        }
        slot += 3;
    }
}

void Solver::correct(std::size_t which) {
    Share::Terminals const& norton = system_->shares.parts[which].norton;
    double *const x = state_.v.data(), *const rhs = rhs_[which].data();
    int const* slot = norton.slots.data();
    for (int const m : norton.index) {
        double const v[3] = {x[slot[0]], x[slot[1]], x[slot[2]]};
        auto const j = circuit_.norton[static_cast<std::size_t>(m)].element->correct(v);
        std::copy(j.begin(), j.end(), correction_.data() + 3 * m);
        slot += 3;
    }
    slot = norton.slots.data();
    int const unknowns = system_->topology.unknowns;
    for (int const m : norton.index) {
        double const* const change = correction_.data() + 3 * m;
        for (int k = 0; k < 3; ++k, ++slot) {
            if (*slot >= unknowns) {
                continue;
            }
            if (system_->dense) {
                system_->add_column(*slot, change[k], x);
            } else {
                rhs[*slot] += change[k];
            }
        }
    }
}

void Solver::finish(std::size_t which, Rule rule, StepCoefficients const& c) {
    Share const& share = system_->shares.parts[which];
    double const* const x = state_.v.data();
    for (std::size_t n = 0; n < share.norton.index.size(); ++n) {
        int const* const slot = share.norton.slots.data() + 3 * n;
        double const v[3] = {x[slot[0]], x[slot[1]], x[slot[2]]};
        circuit_.norton[static_cast<std::size_t>(share.norton.index[n])].element->finish(v);
    }
    currents(share, c);
    waves(share, rule, c);
    cores(share, rule, c);
}

void Solver::solve_rest() {
    if (system_->divided()) {
        system_->factors_in_parts().rest(rhs_.back().data(), state_.v.data());
    } else {
        system_->solve(rhs_.front().data(), state_.v.data());
    }
}

/// What is done with the voltages once the rest is solved.
template <class Job>
void Solver::with_solution(Job const& job) {
    if (!system_->divided()) {
        job(std::size_t{0});
        return;
    }
    auto const up = [&](std::size_t share) {
        system_->factors_in_parts().up(static_cast<int>(share), state_.v.data());
    };
    if (!system_->update) {
        each_part([&](std::size_t share) {
            up(share);
            job(share);
        });
        return;
    }
    each_part(up);
    system_->finish_parts(state_.v.data());
    each_part(job);
}

void Solver::substep(double t_end, double h, Rule rule, StepCoefficients const& c) {
    auto const down = [&](std::size_t share) {
        if (system_->divided()) {
            system_->factors_in_parts().down(static_cast<int>(share), rhs_[share].data());
        }
    };
    source_voltages(t_end);
    each_part([&](std::size_t share) {
        histories(share, t_end, rule, c);
        predict(share, t_end, h, rule);
        down(share);
    });
    for (BergeronWaves& line : waves_) {
        line.open(t_end);
    }
    for (MartiWaves& line : marti_) {
        line.open(t_end);
    }
    int corrections = 0;
    for (NortonPort const& p : circuit_.norton) {
        corrections = std::max(corrections, p.element->corrections());
    }
    fill_rest();
    solve_rest();
    for (int repeat = corrections; repeat > 0; --repeat) {
        with_solution([&](std::size_t share) {
            correct(share);
            down(share);
        });
        for (auto const& [row, at] : system_->shares.rest_norton) {
            rhs_.back()[static_cast<std::size_t>(row)] += correction_[static_cast<std::size_t>(at)];
        }
        if (!system_->dense) {
            solve_rest();
        }
    }
    with_solution([&](std::size_t share) { finish(share, rule, c); });
}

} // namespace gridspace::sim::emt
