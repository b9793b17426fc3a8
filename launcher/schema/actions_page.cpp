// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/schema/schema_pages.hpp"
#include "sim/actions/action_table.hpp"
#include "sim/events/event.hpp"

#include <fmt/format.h>

/// docs/reference/actions.md, from the tables that events, set-points and commands are checked with.
namespace gridspace::launcher {
namespace {

constexpr std::string_view kHead = R"(# What can be done to the grid in a run

*Made by `gridspace schema --write .` from the table that events, set-points and commands are checked with; a test keeps it
current.*

The scenario does it at a time ([`events:`](config.md)), an agent by a sample ([`simulation.controls`](controls.md)). Both find
the same table below. P: phasors (`solver: phasor`), W: waveforms (`solver: emt`).

)";

std::string solvers(bool in_phasors, bool in_waveforms) {
    return in_phasors && in_waveforms ? "P, W" : in_phasors ? "P" : "W";
}

} // namespace

std::string actions_page() {
    std::string out{kHead};
    out += "## Events\n| key | what | by an agent |\n|---|---|---|\n";
    for (sim::EventAction const& action : sim::event_actions()) {
        out += fmt::format("| `{}` | {} | {} |\n", action.key, action.doc, action.of_agents);
    }
    out += "\n## Quantities\nAn event says `set: {batteries.BAT1.p_kw: 5}`, a set-point `battery.BAT1` and `p_kw`. A "
           "value "
           "that is out of\nrange or not finite is refused.\n\n| section | agents say | quantity | unit | range | "
           "solver | "
           "what |\n|---|---|---|---|---|---|---|\n";
    for (sim::ActionKind const& kind : sim::action_kinds()) {
        for (sim::Quantity const& q : kind.settable) {
            std::string const range = sim::range_text(q.range);
            out += fmt::format("| `{}` | `{}` | `{}` | {} | {} | {} | {} |\n", kind.section, kind.prefix, q.name,
                               config::unit_of_key(q.name), range, solvers(q.in_phasors, q.in_waveforms), q.range.doc);
        }
    }
    out += "\n## Commands\n| agents say | command | solver | what |\n|---|---|---|---|\n";
    for (sim::ActionKind const& kind : sim::action_kinds()) {
        for (sim::CommandUse const& use : kind.commands) {
            out += fmt::format("| `{}` | `{}` | {} | {} |\n", kind.prefix,
                               sim::kCommands[static_cast<std::size_t>(use.command)],
                               solvers(use.in_phasors, use.in_waveforms), use.doc);
        }
    }
    out +=
        "\n## Modes\nAn event says `mode: {G1: droop}`, an agent the command `COMMAND_MODE` with the word as `mode`. "
        "At the start the first one\nholds that the element is able to.\n\n| agents say | mode | what "
        "|\n|---|---|---|\n";
    for (sim::ActionKind const& kind : sim::action_kinds()) {
        for (sim::Mode const& mode : kind.modes) {
            out += fmt::format("| `{}` | `{}` | {} |\n", kind.prefix, mode.word, mode.doc);
        }
    }
    return out;
}

} // namespace gridspace::launcher
