// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine_data.hpp"

namespace gridspace::sim::machines {

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
        d.avr = type.avr;
    }
    d.governor = machine.governor ? machine.governor : type.governor;
    d.rating_kva = machine.rating_kva;
    return d;
}

} // namespace gridspace::sim::machines
