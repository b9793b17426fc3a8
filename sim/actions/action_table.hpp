// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/components/faces/element.hpp"
#include "sim/engine/action.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The one table of what can be done to elements of the grid in a run: by `events:` at a time, by agents with a sample.
/// docs/reference/actions.md is made from it.
namespace gridspace::sim {

struct Network;

/// A kind of element, and what can be done to it.
struct ActionKind : Kind {
    std::vector<std::string> (*names)(Network const& network);

    /// Nothing where the kind has no such quantity, or that solver cannot follow it.
    [[nodiscard]] Quantity const* quantity(std::string_view name, bool waveform) const;
    [[nodiscard]] CommandUse const* use(Command command, bool waveform) const;
    [[nodiscard]] std::vector<std::string> quantity_names(bool waveform) const;
};

/// In the order of the list of elements.
[[nodiscard]] std::span<ActionKind const> action_kinds();
[[nodiscard]] ActionKind const* kind_of_section(std::string_view section);
[[nodiscard]] ActionKind const* kind_of_prefix(std::string_view prefix);

/// Finite, and within a range.
[[nodiscard]] bool within(config::NumberSpec const& range, double value);
/// "> 0 and <= 1"; empty: any number.
[[nodiscard]] std::string range_text(config::NumberSpec const& range);

/// What a path of the network file leads to ("loads.AC3.p_kw").
struct Setting {
    ActionKind const* kind{nullptr};
    std::string_view element; ///< a part of the path
    Quantity const* quantity{nullptr};
    [[nodiscard]] bool names(Element const& e) const {
        return e.kind().section == kind->section && e.name.name == element;
    }
};
/// Fails where nothing of this path can be set by that solver, or not to this value. Elements are not looked for.
[[nodiscard]] Result<Setting> setting_of(SetParameter const& action, bool waveform);
[[nodiscard]] Error cannot_be_set(SetParameter const& action, bool waveform);

/// Why this one element refuses what its kind allows in that solver.
[[nodiscard]] std::optional<Refusal> refusal_of(Network const& network, ActionKind const& kind,
                                                std::string_view element, Quantity const& quantity, bool waveform);
/// What a quantity of an element is before anybody has set it.
[[nodiscard]] double start_value(Network const& network, ActionKind const& kind, std::string_view element,
                                 Quantity const& quantity);
/// The values that a quantity of this one element can have.
[[nodiscard]] config::NumberSpec range_of(Network const& network, ActionKind const& kind, std::string_view element,
                                          Quantity const& quantity, bool waveform);
/// What a command does to an element. `mode`: the word of Command::mode.
[[nodiscard]] Action action_of(Command command, std::string element, std::string mode = {});
[[nodiscard]] std::vector<std::string> mode_words(Kind const& kind);
/// Fails where the element of this name has no such mode, and says which there are.
[[nodiscard]] Result<void> check_mode(Network const& network, SetMode const& action);
[[nodiscard]] std::vector<std::string> names_that_follow(Network const& network, Command command, bool waveform);
/// Commands that are given by a bare name, as in `open:` of an event: whether an element of that name follows.
[[nodiscard]] bool follows(Network const& network, std::string_view element, Command command, bool waveform);

} // namespace gridspace::sim
