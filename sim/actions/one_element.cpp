// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"

#include "common/text.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

/// What a kind allows, and one of its elements refuses or has.
namespace gridspace::sim {
namespace {

Element const* element_of(Network const& n, ActionKind const& kind, std::string_view element) {
    return NetworkAround{n}.element(kind.section, Ref{std::string{element}, {}});
}

} // namespace

std::optional<Refusal> refusal_of(Network const& n, ActionKind const& kind, std::string_view element,
                                  Quantity const& quantity, bool waveform) {
    Element const* e = element_of(n, kind, element);
    return e == nullptr ? std::nullopt : e->refuses(quantity.name, NetworkAround{n}, waveform);
}

double start_value(Network const& n, ActionKind const& kind, std::string_view element, Quantity const& quantity) {
    Element const* e = element_of(n, kind, element);
    return e == nullptr ? 0 : e->value(quantity.name, NetworkAround{n});
}

config::NumberSpec range_of(Network const& n, ActionKind const& kind, std::string_view element,
                            Quantity const& quantity, bool waveform) {
    Element const* e = element_of(n, kind, element);
    return e == nullptr ? quantity.range : e->range(quantity, NetworkAround{n}, waveform);
}

Action action_of(Command command, std::string element, std::string mode) {
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
    case Command::mode:
        return SetMode{std::move(element), std::move(mode)};
    case Command::open:
    case Command::close:
        break;
    }
    return SwitchBreaker{std::move(element), command == Command::close};
}

std::vector<std::string> mode_words(Kind const& kind) {
    std::vector<std::string> out;
    for (Mode const& mode : kind.modes) {
        out.emplace_back(mode.word);
    }
    return out;
}

Result<void> check_mode(Network const& n, SetMode const& action) {
    std::string const what = fmt::format("the mode of '{}' cannot be '{}'", action.element, printable(action.mode));
    std::vector<std::string> others;
    for (ActionKind const& kind : action_kinds()) {
        if (kind.modes.empty()) {
            continue;
        }
        Element const* element = element_of(n, kind, action.element);
        if (element == nullptr) {
            std::vector<std::string> const names = kind.names(n);
            others.insert(others.end(), names.begin(), names.end());
            continue;
        }
        std::vector<std::string> const words = mode_words(kind);
        if (std::find(words.begin(), words.end(), action.mode) == words.end()) {
            return fail(ExitCode::usage, what, spelling_hint(action.mode, words));
        }
        auto const refusal = element->refuses_mode(action.mode, NetworkAround{n});
        return refusal ? fail(ExitCode::usage, fmt::format("{}: {}", what, refusal->why), std::string{refusal->hint})
                       : Result<void>{};
    }
    return fail(ExitCode::usage, what + ": there is no such element with modes",
                spelling_hint(action.element, others, "the network has none"));
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
