// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// Changes of the circuit while it is simulated.
namespace gridspace::sim::emt {

void Solver::keep_flux(int branch, double l_before_h, double l_h) {
    for (std::size_t k = 0; k < 3; ++k) {
        state_.rl_i[3 * static_cast<std::size_t>(branch) + k] *= l_before_h / l_h;
    }
}

void Solver::start_inductor(int branch, int beside) {
    auto const b = 3 * static_cast<std::size_t>(branch), other = 3 * static_cast<std::size_t>(beside);
    state_.rl_v.resize(3 * circuit_.rl.size(), 0.0);
    state_.rl_i.resize(3 * circuit_.rl.size(), 0.0);
    double const x_ohm = 2 * std::numbers::pi * circuit_.frequency_hz * circuit_.rl[b / 3].l.one;
    std::copy_n(state_.rl_v.begin() + static_cast<std::ptrdiff_t>(other), 3,
                state_.rl_v.begin() + static_cast<std::ptrdiff_t>(b));
    for (std::size_t k = 0; k < 3; ++k) {
        // Of a positive sequence: a quarter of a period behind a phase is the difference of the two others.
        double const behind_v = state_.rl_v[other + (k + 1) % 3] - state_.rl_v[other + (k + 2) % 3];
        state_.rl_i[b + k] = behind_v / std::numbers::sqrt3 / x_ohm;
    }
}

void Solver::start_capacitor(int branch, int beside) {
    state_.capacitor_v.resize(3 * circuit_.capacitors.size(), 0.0);
    state_.capacitor_i.resize(3 * circuit_.capacitors.size(), 0.0);
    std::copy_n(state_.rl_v.begin() + 3 * static_cast<std::ptrdiff_t>(beside), 3,
                state_.capacitor_v.begin() + 3 * static_cast<std::ptrdiff_t>(branch));
}

int Solver::split_rl(int branch, double share, std::string const& name) {
    auto const old = static_cast<std::size_t>(branch);
    int const middle = circuit_.add_triple(name);
    RlBranch second = circuit_.rl[old];
    auto const scale = [](PhaseMatrix& m, double k) {
        m.one *= k;
        m.mutual *= k;
    };
    scale(second.r, 1 - share);
    scale(second.l, 1 - share);
    second.from = middle;
    RlBranch& first = circuit_.rl[old];
    scale(first.r, share);
    scale(first.l, share);
    first.to = middle;
    circuit_.rl.push_back(second);
    for (std::size_t k = 0; k < 3; ++k) {
        double const v = state_.rl_v[3 * old + k];
        state_.rl_v.push_back(v * (1 - share));
        state_.rl_v[3 * old + k] = v * share;
        state_.rl_i.push_back(state_.rl_i[3 * old + k]);
    }
    return static_cast<int>(circuit_.rl.size()) - 1;
}

int Solver::split_coupled(int branch, double share, std::string const& name) {
    auto const old = static_cast<std::size_t>(branch);
    int const middle = circuit_.add_triple(name);
    CoupledBranch second = circuit_.coupled[old];
    auto const scale = [](Matrix3& m, double k) { m = combined(k, m, 0.0, m); };
    scale(second.r, 1 - share);
    scale(second.l, 1 - share);
    second.from = middle;
    CoupledBranch& first = circuit_.coupled[old];
    scale(first.r, share);
    scale(first.l, share);
    first.to = middle;
    circuit_.coupled.push_back(second);
    for (std::size_t k = 0; k < 3; ++k) {
        double const v = state_.coupled_v[3 * old + k];
        state_.coupled_v.push_back(v * (1 - share));
        state_.coupled_v[3 * old + k] = v * share;
        state_.coupled_i.push_back(state_.coupled_i[3 * old + k]);
    }
    return static_cast<int>(circuit_.coupled.size()) - 1;
}

Solver::WaveParts Solver::split_wave(int line, double share, std::string const& name) {
    auto const old = static_cast<std::size_t>(line);
    BergeronLine const whole = circuit_.bergeron[old];
    BergeronWaves const waves = waves_[old];
    int const middle = circuit_.add_triple(name);
    auto const here = waves.inside(t_, share);
    // What flows at the ends goes on, in whatever piece is there.
    std::array<double, 6> ends{};
    std::copy_n(state_.wave_i.begin() + static_cast<std::ptrdiff_t>(6 * old), 6, ends.begin());
    WaveParts out;
    bool taken = false; // the place of the old line
    auto const piece = [&](int from, int to, double x0, double x1, bool& is_wave) {
        double const length = x1 - x0;
        is_wave = length * std::min(whole.tau1, whole.tau0) >= step_s_;
        if (!is_wave) {
            PhaseMatrix const l = PhaseMatrix::sequence(whole.z1 * whole.tau1 * length, whole.z0 * whole.tau0 * length);
            circuit_.rl.push_back({from, to, PhaseMatrix::sequence(whole.r1 * length, whole.r0 * length), l});
            circuit_.capacitors.push_back(
                {middle, kEarth,
                 PhaseMatrix::sequence(whole.tau1 / whole.z1 * length, whole.tau0 / whole.z0 * length)});
            for (std::size_t k = 0; k < 3; ++k) {
                state_.rl_v.push_back(0);
                state_.rl_i.push_back(x0 > 0 ? -ends[3 + k] : ends[k]);
                state_.capacitor_v.push_back(here.v[k]);
                state_.capacitor_i.push_back(0);
            }
            return static_cast<int>(circuit_.rl.size()) - 1;
        }
        BergeronLine part = whole;
        part.from = from;
        part.to = to;
        part.tau1 *= length;
        part.tau0 *= length;
        part.r1 *= length;
        part.r0 *= length;
        BergeronWaves moving{part, step_s_};
        moving.continue_from(waves, t_, x0, x1);
        if (taken) {
            circuit_.bergeron.push_back(part);
            waves_.push_back(std::move(moving));
            return static_cast<int>(circuit_.bergeron.size()) - 1;
        }
        taken = true;
        circuit_.bergeron[old] = part;
        waves_[old] = std::move(moving);
        return line;
    };
    out.near_index = piece(whole.from, middle, 0, share, out.near_is_wave);
    out.far_index = piece(middle, whole.to, share, 1, out.far_is_wave);
    state_.wave_i.resize(6 * circuit_.bergeron.size());
    for (std::size_t k = 0; k < 3; ++k) {
        if (out.near_is_wave) {
            state_.wave_i[6 * static_cast<std::size_t>(out.near_index) + k] = ends[k];
            state_.wave_i[6 * static_cast<std::size_t>(out.near_index) + 3 + k] = -here.i[k];
        }
        if (out.far_is_wave) {
            state_.wave_i[6 * static_cast<std::size_t>(out.far_index) + k] = here.i[k];
            state_.wave_i[6 * static_cast<std::size_t>(out.far_index) + 3 + k] = ends[3 + k];
        }
    }
    return out;
}

void Solver::set_source_frequency(std::size_t source, double frequency_hz) {
    VoltageSource& s = circuit_.sources[source];
    source_phase_[source] += 2 * std::numbers::pi * s.frequency_hz * (t_ - source_since_[source]);
    source_phase_[source] = std::fmod(source_phase_[source], 2 * std::numbers::pi);
    source_since_[source] = t_;
    s.frequency_hz = frequency_hz;
}

void Solver::set_source_amplitude(std::size_t source, double amplitude_v) {
    circuit_.sources[source].amplitude_v = amplitude_v;
    damping_s_ = kDampedSteps * step_s_;
}

} // namespace gridspace::sim::emt
