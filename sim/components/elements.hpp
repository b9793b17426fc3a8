// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/battery/battery.hpp"
#include "sim/components/breaker/breaker.hpp"
#include "sim/components/bus/bus.hpp"
#include "sim/components/ct/ct.hpp"
#include "sim/components/electrolyser/electrolyser.hpp"
#include "sim/components/ev/ev.hpp"
#include "sim/components/fuse/fuse.hpp"
#include "sim/components/generator/generator.hpp"
#include "sim/components/induction_machine/induction_machine.hpp"
#include "sim/components/line/line.hpp"
#include "sim/components/load/load.hpp"
#include "sim/components/machine/machine.hpp"
#include "sim/components/profile/profile.hpp"
#include "sim/components/pv/pv.hpp"
#include "sim/components/shunt/shunt.hpp"
#include "sim/components/shunt_capacitor/shunt_capacitor.hpp"
#include "sim/components/source/source.hpp"
#include "sim/components/supercapacitor/supercapacitor.hpp"
#include "sim/components/transformer/transformer.hpp"
#include "sim/components/vt/vt.hpp"
#include "sim/components/wind_turbine/wind_turbine.hpp"

#include <concepts>
#include <utility>
#include <vector>

namespace gridspace::sim {

/// What a network file names, by kind.
struct Elements {
    std::vector<Bus> buses;
    std::vector<LineType> line_types;
    std::vector<Line> lines;
    std::vector<Source> sources;
    std::vector<Generator> generators;
    std::vector<MachineType> machine_types;
    std::vector<Machine> machines;
    std::vector<Transformer> transformers;
    std::vector<Load> loads;
    std::vector<Shunt> shunts;
    std::vector<Pv> pv;
    std::vector<Ev> evs;
    std::vector<Battery> batteries;
    std::vector<ShuntCapacitor> shunt_capacitors;
    std::vector<InductionMachine> induction_machines;
    std::vector<WindTurbine> wind_turbines;
    std::vector<Electrolyser> electrolysers;
    std::vector<Supercapacitor> supercapacitors;
    std::vector<BreakerType> breaker_types;
    std::vector<Breaker> breakers;
    std::vector<CtType> ct_types;
    std::vector<Ct> cts;
    std::vector<VtType> vt_types;
    std::vector<Vt> vts;
    std::vector<FuseType> fuse_types;
    std::vector<Fuse> fuses;
    std::vector<Profile> profiles;
};

/// Calls visit(vector) for the elements of each kind, in the order in which everybody takes them up: sums, states and
/// signals are in this order, so it decides the last bits of results. New kinds go to its end.
template <class E, class Visit>
void for_each_kind(E& elements, Visit const& visit) {
    visit(elements.buses);
    visit(elements.line_types);
    visit(elements.lines);
    visit(elements.sources);
    visit(elements.generators);
    visit(elements.machine_types);
    visit(elements.machines);
    visit(elements.transformers);
    visit(elements.loads);
    visit(elements.shunts);
    visit(elements.pv);
    visit(elements.evs);
    visit(elements.batteries);
    visit(elements.shunt_capacitors);
    visit(elements.induction_machines);
    visit(elements.wind_turbines);
    visit(elements.electrolysers);
    visit(elements.supercapacitors);
    visit(elements.breaker_types);
    visit(elements.breakers);
    visit(elements.ct_types);
    visit(elements.cts);
    visit(elements.vt_types);
    visit(elements.vts);
    visit(elements.fuse_types);
    visit(elements.fuses);
    visit(elements.profiles);
}

/// All with this face, in the order of the list.
template <class Face, class E>
[[nodiscard]] auto all(E& elements) {
    using Pointer = std::conditional_t<std::is_const_v<E>, Face const*, Face*>;
    std::vector<Pointer> out;
    for_each_kind(elements, [&]<class Vector>(Vector& kind) {
        if constexpr (std::derived_from<typename Vector::value_type, Face>) {
            for (auto& element : kind) {
                out.push_back(&element);
            }
        }
    });
    return out;
}
[[nodiscard]] std::vector<OnePort const*> one_ports(Elements const& e);
[[nodiscard]] std::vector<TwoPort const*> two_ports(Elements const& e);

} // namespace gridspace::sim
