// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"

#include <algorithm>
#include <utility>

/// What a kind allows, and one of its elements refuses or has.
namespace gridspace::sim {
namespace {

OnePort const* one_port_of(Network const& n, ActionKind const& kind, std::string_view element) {
    for (OnePort const* e : one_ports(n)) {
        if (e->kind().section == kind.section && e->name.name == element) {
            return e;
        }
    }
    return nullptr;
}

Governor const* governor_of(Network const& n, Machine const& machine) {
    MachineType const* type = find(n.machine_types, machine.type.name);
    return machine.governor ? &*machine.governor : type != nullptr && type->governor ? &*type->governor : nullptr;
}

std::optional<Refusal> refusal_of(Generator const& g, std::string_view quantity) {
    if (g.role == GeneratorRole::slack && quantity != "voltage_setpoint_pu") {
        return Refusal{"a generator of role slack gives what the network needs", "set the powers of others"};
    }
    if (g.role == GeneratorRole::pv && quantity == "q_kvar") {
        return Refusal{"a generator of role pv gives the reactive power that its voltage needs",
                       "set its voltage_setpoint_pu"};
    }
    return g.role == GeneratorRole::pq && quantity == "voltage_setpoint_pu"
               ? std::optional{Refusal{"a generator of role pq holds no voltage", "set its q_kvar"}}
               : std::nullopt;
}

} // namespace

std::optional<Refusal> refusal_of(Network const& n, ActionKind const& kind, std::string_view element,
                                  Quantity const& quantity, bool waveform) {
    Source const* source = kind.section == "sources" ? find(n.sources, element) : nullptr;
    if (source != nullptr && !waveform && quantity.name == "frequency_hz" && source->r_ohm == 0 && source->l_mh == 0) {
        return Refusal{"with phasors a source without an impedance holds the angle of its bus", "give it an l_mh"};
    }
    if (OnePort const* e = one_port_of(n, kind, element)) {
        return e->refuses(quantity.name);
    }
    if (Generator const* g = kind.section == "generators" ? find(n.generators, element) : nullptr) {
        return refusal_of(*g, quantity.name);
    }
    Machine const* machine = kind.section == "machines" ? find(n.machines, element) : nullptr;
    if (machine != nullptr && quantity.name == "droop_percent" && governor_of(n, *machine) == nullptr) {
        return Refusal{"this machine has no governor", "give it or its type a `governor`"};
    }
    return {};
}

double start_value(Network const& n, ActionKind const& kind, std::string_view element, Quantity const& quantity) {
    if (OnePort const* e = one_port_of(n, kind, element)) {
        return e->value(quantity.name);
    }
    if (Source const* s = kind.section == "sources" ? find(n.sources, element) : nullptr) {
        return quantity.name == "voltage_pu" ? s->voltage_pu : n.frequency_hz;
    }
    if (Generator const* g = kind.section == "generators" ? find(n.generators, element) : nullptr) {
        return quantity.name == "p_kw" ? g->p_kw : quantity.name == "q_kvar" ? g->q_kvar : g->voltage_setpoint_pu;
    }
    if (Transformer const* t = kind.section == "transformers" ? find(n.transformers, element) : nullptr) {
        return t->tap_ratio;
    }
    if (Machine const* m = kind.section == "machines" ? find(n.machines, element) : nullptr) {
        Governor const* governor = governor_of(n, *m);
        return quantity.name == "p_kw"                  ? m->p_kw
               : quantity.name == "voltage_setpoint_pu" ? m->voltage_setpoint_pu
               : governor == nullptr                    ? 0
                                                        : governor->droop_percent;
    }
    return 0;
}

Action action_of(Command command, std::string element) {
    switch (command) {
    case Command::connect:
        return Connect{std::move(element)};
    case Command::disconnect:
        return Disconnect{std::move(element)};
    case Command::start:
    case Command::stop:
        return StandBy{std::move(element), command == Command::stop};
    case Command::reset:
        return Repair{std::move(element)};
    case Command::open:
    case Command::close:
    case Command::mode:
        break;
    }
    return SwitchBreaker{std::move(element), command == Command::close};
}

std::vector<std::string> names_that_follow(Network const& n, Command command, bool waveform) {
    std::vector<std::string> out;
    for (ActionKind const& kind : action_kinds()) {
        if (kind.use(command, waveform) != nullptr) {
            std::vector<std::string> const names = kind.names(n);
            out.insert(out.end(), names.begin(), names.end());
        }
    }
    return out;
}

bool follows(Network const& n, std::string_view element, Command command, bool waveform) {
    std::vector<std::string> const names = names_that_follow(n, command, waveform);
    return std::find(names.begin(), names.end(), element) != names.end();
}

} // namespace gridspace::sim
