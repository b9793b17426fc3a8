// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/branch.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim {

SwitchState::SwitchState(Network const& network) : out(two_ports(network).size(), false) {
    for (LineSwitch const* s : all<LineSwitch>(network)) {
        switch_closed.push_back(s->closed_at_start());
    }
}

Ends SwitchState::closed(Network const& network, Ref const& line) const {
    Ends ends;
    std::vector<LineSwitch const*> const switches = all<LineSwitch>(network);
    for (std::size_t i = 0; i < switches.size(); ++i) {
        if (switches[i]->line == line && !switch_closed[i]) {
            (switches[i]->end == LineEnd::from ? ends.from : ends.to) = false;
        }
    }
    return ends;
}

double lead_of(Branch const& b) {
    if (b.ft == b.tf || b.ft == Complex{} || b.tt == Complex{}) {
        return 0;
    }
    double const twice = std::arg(b.tf / b.ft), angle = twice / 2;
    bool const opposite = std::cos(std::arg(-b.tf / b.tt) - angle) < 0;
    return opposite ? angle + std::numbers::pi : angle;
}

std::vector<Branch> branches(Network const& network, SwitchState const& state) {
    NetworkAround const around{network};
    std::vector<TwoPort const*> const elements = two_ports(network);
    std::vector<Branch> out;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        TwoPort const& e = *elements[i];
        if (!state.out[i]) {
            out.push_back(
                {e.admittances(around, state.closed(network, e.name)), i, around.bus(e.from), around.bus(e.to)});
        }
    }
    return out;
}

} // namespace gridspace::sim
