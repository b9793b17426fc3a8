// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <cmath>
#include <numbers>

/// The steady state from which a simulation starts. Reactances are taken at the frequency at which the trapezoidal rule
/// turns nominal frequency into exact steady state, w' = 2/h tan(w h/2): nothing is left over that would have to
/// settle.
namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

/// Positive sequence phasor of a phase.
Complex phase_of(Complex a, int k) {
    return a * std::polar(1.0, -k * 2 * std::numbers::pi / 3);
}

ComplexPhaseMatrix impedance_inverse(PhaseMatrix const& r, PhaseMatrix const& l, double w) {
    return ComplexPhaseMatrix::sequence(1.0 / Complex{r.one, w * l.one}, 1.0 / Complex{r.zero(), w * l.zero()});
}

} // namespace

Result<void> Solver::start(std::vector<NortonStart> const& norton_starts,
                           std::vector<std::array<Complex, 3>> const& injection_starts, bool unbalanced) {
    t_ = 0;
    if (auto ok = use(step_s_); !ok) {
        return ok;
    }
    double const w0 = 2 * std::numbers::pi * circuit_.frequency_hz;
    double const w = 2 / step_s_ * std::tan(w0 * step_s_ / 2);
    double const speed = w / w0;
    Admittances<Complex> y;
    for (RlBranch const& b : circuit_.rl) {
        y.rl.push_back(impedance_inverse(b.r, b.l, w));
    }
    for (CapacitorBranch const& b : circuit_.capacitors) {
        y.capacitors.push_back(ComplexPhaseMatrix::sequence({0, w * b.c.one}, {0, w * b.c.zero()}));
    }
    for (CoupledBranch const& b : circuit_.coupled) {
        Matrix3Of<Complex> impedance{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                impedance[i][j] = b.kind == CoupledBranch::Kind::capacitive ? Complex{0, w * b.c[i][j]}
                                                                            : Complex{b.r[i][j], w * b.l[i][j]};
            }
        }
        y.coupled.push_back(b.kind == CoupledBranch::Kind::capacitive ? impedance : inverse(impedance));
    }
    for (Winding const& b : circuit_.windings) {
        y.windings.push_back(1.0 / Complex{b.r, w * b.l});
    }
    for (SaturableCore const& b : circuit_.cores) {
        y.cores.push_back(1.0 / Complex{0, w * b.l});
    }
    for (NortonPort const& p : circuit_.norton) {
        y.norton.push_back(p.element->steady_admittance(speed));
    }
    for (BergeronWaves const& line : waves_) { // true delays: they know the true frequency
        auto const steady = line.steady(w0);
        y.bergeron.push_back(steady.own);
        y.bergeron_cross.push_back(steady.cross);
    }
    for (std::size_t i = 0; i < marti_.size(); ++i) {
        auto const steady = marti_[i].steady(usual_.marti[i], w0);
        y.marti.push_back(steady.own);
        y.marti_cross.push_back(steady.cross);
    }
    Topology const& t = system_->topology;
    auto const assembly = assemble(circuit_, t, bits_, y);
    Ldlt<Complex> factors;
    (void)factors.factor(t.unknowns, assembly.matrix);
    std::vector<Complex> v(static_cast<std::size_t>(t.slots));
    for (std::size_t s = 0; s < circuit_.sources.size(); ++s) {
        for (int k = 0; k < 3; ++k) {
            v[static_cast<std::size_t>(t.earth() + 1) + 3 * s + static_cast<std::size_t>(k)] =
                phase_of(std::polar(circuit_.sources[s].amplitude_v, circuit_.sources[s].angle_rad), k);
        }
    }
    std::vector<Complex> rhs(v.size());
    for (auto const& e : assembly.coupling) {
        rhs[static_cast<std::size_t>(e.row)] -= e.value * v[static_cast<std::size_t>(e.column)];
    }
    auto const slot = [&](int node) { return static_cast<std::size_t>(t.slot[static_cast<std::size_t>(node)]); };
    auto const norton_current = [&](std::size_t m) {
        return norton_starts[m].i + y.norton[m].one * norton_starts[m].v;
    };
    for (std::size_t m = 0; m < circuit_.norton.size(); ++m) {
        for (int k = 0; k < 3; ++k) {
            rhs[slot(circuit_.norton[m].node + k)] += phase_of(norton_current(m), k);
        }
    }
    for (std::size_t i = 0; i < injection_starts.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            Complex const current = injection_starts[i][static_cast<std::size_t>(k)];
            rhs[slot(circuit_.injections[i].node + k)] += current;
            injected_[3 * i + static_cast<std::size_t>(k)] = current.real();
        }
    }
    factors.solve(rhs.data());
    std::copy(rhs.begin(), rhs.begin() + t.unknowns, v.begin());
    for (std::size_t i = 0; i < v.size(); ++i) {
        state_.v[i] = v[i].real();
    }
    auto const set_branch = [&](int from, int to, ComplexPhaseMatrix const& admittance, double* volts,
                                double* amperes) {
        std::array<Complex, 3> d;
        Complex sum{};
        for (int k = 0; k < 3; ++k) {
            d[static_cast<std::size_t>(k)] = v[slot(from + k)] - v[slot(to + k)];
            sum += d[static_cast<std::size_t>(k)];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            volts[k] = d[k].real();
            amperes[k] = (admittance.one * d[k] + admittance.mutual * sum).real();
        }
    };
    for (std::size_t b = 0; b < circuit_.rl.size(); ++b) {
        set_branch(circuit_.rl[b].from, circuit_.rl[b].to, y.rl[b], &state_.rl_v[3 * b], &state_.rl_i[3 * b]);
    }
    for (std::size_t b = 0; b < circuit_.capacitors.size(); ++b) {
        set_branch(circuit_.capacitors[b].from, circuit_.capacitors[b].to, y.capacitors[b], &state_.capacitor_v[3 * b],
                   &state_.capacitor_i[3 * b]);
    }
    for (std::size_t b = 0; b < circuit_.coupled.size(); ++b) {
        std::array<Complex, 3> d;
        for (int k = 0; k < 3; ++k) {
            d[static_cast<std::size_t>(k)] =
                v[slot(circuit_.coupled[b].from + k)] - v[slot(circuit_.coupled[b].to + k)];
        }
        for (std::size_t k = 0; k < 3; ++k) {
            auto const& row = y.coupled[b][k];
            state_.coupled_v[3 * b + k] = d[k].real();
            state_.coupled_i[3 * b + k] = (row[0] * d[0] + row[1] * d[1] + row[2] * d[2]).real();
        }
    }
    using EndPhasors = std::array<std::array<Complex, 3>, 2>;
    auto const at_ends = [&](auto const& line, ComplexPhaseMatrix const& own, ComplexPhaseMatrix const& cross,
                             EndPhasors& volts, EndPhasors& amperes, double* currents) {
        std::array<int, 2> const nodes{line.from, line.to};
        std::array<Complex, 2> sum{};
        for (std::size_t end = 0; end < 2; ++end) {
            for (int k = 0; k < 3; ++k) {
                volts[end][static_cast<std::size_t>(k)] = v[slot(nodes[end] + k)];
                sum[end] += v[slot(nodes[end] + k)];
            }
        }
        for (std::size_t end = 0; end < 2; ++end) {
            for (std::size_t k = 0; k < 3; ++k) {
                amperes[end][k] = own.one * volts[end][k] + own.mutual * sum[end] + cross.one * volts[1 - end][k] +
                                  cross.mutual * sum[1 - end];
                currents[3 * end + k] = amperes[end][k].real();
            }
        }
    };
    EndPhasors end_v, end_i;
    for (std::size_t b = 0; b < waves_.size(); ++b) {
        at_ends(circuit_.bergeron[b], y.bergeron[b], y.bergeron_cross[b], end_v, end_i, &state_.wave_i[6 * b]);
        waves_[b].start(w0, end_v, end_i);
    }
    for (std::size_t b = 0; b < marti_.size(); ++b) {
        at_ends(circuit_.marti[b], y.marti[b], y.marti_cross[b], end_v, end_i, &state_.marti_i[6 * b]);
        marti_[b].start(usual_.marti[b], w0, end_v, end_i);
    }
    auto const across = [&](auto const& element) {
        Complex sum{};
        for (std::size_t k = 0; k < 4; ++k) {
            sum += element.weights[k] * v[slot(element.nodes[k])];
        }
        return sum;
    };
    for (std::size_t i = 0; i < circuit_.windings.size(); ++i) {
        Complex const volts = across(circuit_.windings[i]);
        state_.winding_v[i] = volts.real();
        state_.winding_i[i] = (y.windings[i] * volts).real();
    }
    for (std::size_t i = 0; i < circuit_.cores.size(); ++i) {
        Complex const volts = across(circuit_.cores[i]);
        state_.core_v[i] = volts.real();
        state_.core_flux[i] = (volts / Complex{0, w}).real();
        state_.core_i[i] = state_.core_flux[i] / circuit_.cores[i].l;
    }
    started_.clear();
    for (std::size_t m = 0; m < circuit_.norton.size(); ++m) {
        NortonPort const& port = circuit_.norton[m];
        // The positive sequence is what phase a shows of a balanced state.
        Complex volts{};
        for (int k = 0; k < 3; ++k) {
            volts += v[slot(port.node + k)] * std::polar(1.0 / 3, k * 2 * std::numbers::pi / 3);
        }
        started_.push_back({volts, norton_current(m) - y.norton[m].one * volts});
        port.element->start(volts, started_.back().i, speed);
        if (unbalanced) {
            std::array<double, 3> phase_v{}, phase_i{};
            Complex sum{};
            for (int k = 0; k < 3; ++k) {
                sum += v[slot(port.node + k)];
            }
            for (int k = 0; k < 3; ++k) {
                Complex const at = v[slot(port.node + k)];
                Complex const drawn = y.norton[m].one * at + y.norton[m].mutual * sum;
                phase_v[static_cast<std::size_t>(k)] = at.real();
                phase_i[static_cast<std::size_t>(k)] = (phase_of(norton_current(m), k) - drawn).real();
            }
            port.element->start_unbalanced(phase_v, phase_i);
        }
    }
    start_v_ = std::move(v);
    damping_s_ = 0;
    return {};
}

Complex Solver::start_voltage(int node) const {
    return start_v_[static_cast<std::size_t>(system_->topology.slot[static_cast<std::size_t>(node)])];
}

} // namespace gridspace::sim::emt
