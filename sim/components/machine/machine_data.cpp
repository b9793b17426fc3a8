// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine_data.hpp"

#include "sim/components/machine/rotor_state.hpp"

namespace gridspace::sim::machines {
namespace {

/// How many of the states move.
std::size_t moving_states(MachineData const& d) {
    if (d.governor && d.governor->degov) {
        return d.governor->degov->td_s > 0 ? std::size_t{kStates} : std::size_t{kDeadTime};
    }
    if (!d.classical && d.avr) {
        Avr const& r = *d.avr;
        if (r.ac8b) {
            return std::size_t{kRegulator} + 1;
        }
        if (r.tb_s > 0 || r.kf > 0 || r.stabilizer) {
            return std::size_t{kSecond} + 1;
        }
    }
    return d.governor && d.governor->load_limit ? std::size_t{kExhaust} + 1 : std::size_t{kExhaust};
}

} // namespace

MachineData machine_data(Machine const& machine, Surroundings const& around) {
    MachineType const& type = *around.find<MachineType>(machine.type);
    MachineData d;
    d.xd = type.pu.xd;
    d.xq = type.pu.xq;
    d.xd1 = type.pu.xd1;
    d.x2d = type.pu.xd2;
    d.x2q = type.pu.xq2;
    d.xl = type.pu.xl;
    d.x0 = type.pu.x0;
    d.ra = type.pu.ra;
    d.td01 = type.td01_s;
    d.td02 = type.td02_s;
    d.tq02 = type.tq02_s;
    d.h = machine.inertia_h_s.value_or(type.inertia_h_s);
    d.damping = type.damping_pu;
    d.classical = type.model == MachineModel::classical;
    if (d.classical) {
        d.xd = d.xq = d.x2d = d.x2q = d.xd1;
    } else {
        d.gamma_d = (d.x2d - d.xl) / (d.xd1 - d.xl);
        d.gamma_q = (d.xq - d.x2q) / (d.xq - d.xl);
        d.coupling = (d.xd1 - d.x2d) / ((d.xd1 - d.xl) * (d.xd1 - d.xl));
        if (auto const& s = type.saturation) {
            d.saturation = Saturation::through(1, s->s10, 1.2, s->s12);
        }
        d.avr = type.avr;
        if (d.avr && d.avr->ac8b) {
            Ac8b const& a = *d.avr->ac8b;
            d.exciter = Saturation::through(a.e1_pu, a.se_e1, a.e2_pu, a.se_e2);
        }
    }
    d.governor = machine.governor ? machine.governor : type.governor;
    d.rating_kva = machine.rating_kva;
    d.states = moving_states(d);
    return d;
}

} // namespace gridspace::sim::machines
