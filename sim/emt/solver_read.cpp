// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <algorithm>

/// What can be read of a solution.
namespace gridspace::sim::emt {

double Solver::current(CurrentTerm const& term, int phase) const {
    using Kind = CurrentTerm::Kind;
    auto const i = static_cast<std::size_t>(term.index);
    auto const k = static_cast<std::size_t>(phase);
    switch (term.kind) {
    case Kind::rl:
        return term.sign * state_.rl_i[3 * i + k];
    case Kind::capacitor:
        return term.sign * state_.capacitor_i[3 * i + k];
    case Kind::coupled:
        return term.sign * state_.coupled_i[3 * i + k];
    case Kind::winding: // sign is the weight; the index of the limb of phase a
        return term.sign * state_.winding_i[i + (k + static_cast<std::size_t>(term.turn)) % 3];
    case Kind::core:
        return term.sign * state_.core_i[i + (k + static_cast<std::size_t>(term.turn)) % 3];
    case Kind::bergeron_from:
        return term.sign * state_.wave_i[6 * i + k];
    case Kind::bergeron_to:
        return term.sign * state_.wave_i[6 * i + 3 + k];
    case Kind::marti_from:
        return term.sign * state_.marti_i[6 * i + k];
    case Kind::marti_to:
        return term.sign * state_.marti_i[6 * i + 3 + k];
    case Kind::fault:
        return term.sign * fault_current(i, phase);
    case Kind::norton:
        return term.sign * circuit_.norton[i].element->current_a(phase);
    case Kind::injection:
        return term.sign * injected_[3 * i + k];
    }
    return 0;
}

double Solver::switch_current(std::size_t index, int phase) const {
    double sum = 0;
    for (CurrentTerm const& term : circuit_.switches[index].terms) {
        sum += current(term, phase);
    }
    return sum;
}

double Solver::fault_current(std::size_t index, int phase) const {
    FaultBranch const& f = circuit_.faults[index];
    Conductances const g = fault_conductances(f, bits_.faulted[index]);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        sum += g[static_cast<std::size_t>(phase)][static_cast<std::size_t>(k)] * node_voltage(f.node + k);
    }
    return sum;
}

std::vector<std::string> Solver::floating_nodes() const {
    std::vector<std::string> out;
    auto const& slots = system_->topology.slot;
    for (int const unknown : system_->anchored) {
        auto const node = std::find(slots.begin(), slots.end(), unknown) - slots.begin();
        out.push_back(circuit_.node_name(static_cast<int>(node)));
    }
    return out;
}

} // namespace gridspace::sim::emt
