// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/grid_inputs.hpp"

#include "sim/network/network.hpp"

#include <fmt/format.h>

namespace gridspace::sim {
namespace {

/// Commands that are one state of an element, and how that is called.
struct Pair {
    std::string_view state;
    Command on, off;
};
constexpr Pair kPairs[] = {
    {"closed", Command::close, Command::open},
    {"connected", Command::connect, Command::disconnect},
    {"running", Command::start, Command::stop},
};

std::string doc_of(Pair const& pair, ActionKind const& kind, bool waveform) {
    CommandUse const* const on = kind.use(pair.on, waveform);
    return fmt::format("false: {}; true: {}", kind.use(pair.off, waveform)->doc,
                       on == nullptr ? "there is no way back" : on->doc);
}

bool closed_at_start(Element const& element) {
    if (auto const* line_switch = dynamic_cast<LineSwitch const*>(&element)) {
        return line_switch->closed_at_start();
    }
    auto const* one_port = dynamic_cast<OnePort const*>(&element);
    return one_port == nullptr || one_port->closed_at_start();
}

void add_set_points(Network const& n, ActionKind const& kind, std::string const& element, bool waveform,
                    std::vector<GridInput>& out) {
    for (std::string const& name : kind.quantity_names(waveform)) {
        Quantity const& quantity = *kind.quantity(name, waveform);
        if (refusal_of(n, kind, element, quantity, waveform)) {
            continue;
        }
        GridInput input;
        input.name = fmt::format("set_point.{}.{}.{}", kind.prefix, element, name);
        input.unit = config::unit_of_key(name);
        input.range = range_of(n, kind, element, quantity, waveform);
        std::string const range = range_text(input.range);
        input.doc = range.empty() ? std::string{quantity.range.doc} : fmt::format("{}; {}", quantity.range.doc, range);
        input.start = start_value(n, kind, element, quantity) + 0.0; // no -0
        input.element = element;
        input.path = fmt::format("{}.{}.{}", kind.section, element, name);
        out.push_back(std::move(input));
    }
}

void add_commands(Network const& n, ActionKind const& kind, std::string const& element, bool waveform,
                  std::vector<GridInput>& out) {
    for (Pair const& pair : kPairs) {
        if (kind.use(pair.off, waveform) == nullptr) {
            continue;
        }
        GridInput input;
        input.name = fmt::format("command.{}.{}.{}", kind.prefix, element, pair.state);
        input.doc = doc_of(pair, kind, waveform);
        input.is_command = true;
        input.on_at_start =
            pair.on != Command::close || closed_at_start(*NetworkAround{n}.element(kind.section, {element, {}}));
        input.element = element;
        input.on = pair.on;
        input.off = pair.off;
        out.push_back(std::move(input));
    }
}

void add_mode(Network const& n, ActionKind const& kind, std::string const& element, bool waveform,
              std::vector<GridInput>& out) {
    CommandUse const* const use = kind.use(Command::mode, waveform);
    if (use == nullptr) {
        return;
    }
    NetworkAround const around{n};
    GridInput input;
    for (std::string const& word : mode_words(kind)) {
        if (!around.element(kind.section, {element, {}})->refuses_mode(word, around)) {
            input.modes.push_back(word);
        }
    }
    if (input.modes.size() < 2) {
        return; // there is no choice
    }
    input.name = fmt::format("command.{}.{}.mode", kind.prefix, element);
    input.doc = use->doc;
    input.start = 1;
    input.element = element;
    out.push_back(std::move(input));
}

} // namespace

Action GridInput::action(double value) const {
    if (!modes.empty()) {
        return SetMode{element, modes.at(static_cast<std::size_t>(value) - 1)};
    }
    return is_command ? action_of(value != 0 ? on : off, element) : Action{SetParameter{path, value}};
}

std::vector<GridInput> grid_inputs(Network const& n, bool waveform) {
    std::vector<GridInput> out;
    for (ActionKind const& kind : action_kinds()) {
        for (std::string const& element : kind.names(n)) {
            add_set_points(n, kind, element, waveform, out);
            add_commands(n, kind, element, waveform, out);
            add_mode(n, kind, element, waveform, out);
        }
    }
    return out;
}

} // namespace gridspace::sim
