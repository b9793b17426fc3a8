// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"

#include "common/text.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <type_traits>
#include <utility>

namespace gridspace::sim {
namespace {

/// Kinds of which something can be set or that follow commands.
std::vector<ActionKind> all_kinds() {
    std::vector<ActionKind> out;
    Elements const none;
    for_each_kind(none, [&]<class T>(std::vector<T> const&) {
        Kind const& kind = T::kKind;
        if (!kind.settable.empty() || !kind.commands.empty()) {
            out.push_back({kind, [](Network const& n) {
                               std::vector<std::string> names;
                               for_each_kind(n, [&]<class U>(std::vector<U> const& elements) {
                                   if constexpr (std::is_same_v<T, U>) {
                                       for (U const& e : elements) {
                                           names.push_back(e.name.name);
                                       }
                                   }
                               });
                               return names;
                           }});
        }
    });
    return out;
}

std::vector<ActionKind> const& kinds() {
    static std::vector<ActionKind> const all = all_kinds();
    return all;
}

ActionKind const* kind_where(std::string_view ActionKind::* word, std::string_view is) {
    auto const found = std::find_if(kinds().begin(), kinds().end(), [&](ActionKind const& k) { return k.*word == is; });
    return found == kinds().end() ? nullptr : &*found;
}

/// "loads.<name>.p_kw, ..."
std::string settable_paths(bool waveform) {
    std::vector<std::string> out;
    for (ActionKind const& kind : kinds()) {
        for (std::string const& quantity : kind.quantity_names(waveform)) {
            out.push_back(fmt::format("{}.<name>.{}", kind.section, quantity));
        }
    }
    return join(out, ", ");
}

} // namespace

Quantity const* ActionKind::quantity(std::string_view name, bool waveform) const {
    auto const found = std::find_if(settable.begin(), settable.end(), [&](Quantity const& q) {
        return q.name == name && (waveform ? q.in_waveforms : q.in_phasors);
    });
    return found == settable.end() ? nullptr : &*found;
}

CommandUse const* ActionKind::use(Command command, bool waveform) const {
    auto const found = std::find_if(commands.begin(), commands.end(), [&](CommandUse const& c) {
        return c.command == command && (waveform ? c.in_waveforms : c.in_phasors);
    });
    return found == commands.end() ? nullptr : &*found;
}

std::vector<std::string> ActionKind::quantity_names(bool waveform) const {
    std::vector<std::string> out;
    for (Quantity const& q : settable) {
        if (waveform ? q.in_waveforms : q.in_phasors) {
            out.emplace_back(q.name);
        }
    }
    return out;
}

std::span<ActionKind const> action_kinds() {
    return kinds();
}
ActionKind const* kind_of_section(std::string_view section) {
    return kind_where(&ActionKind::section, section);
}
ActionKind const* kind_of_prefix(std::string_view prefix) {
    return kind_where(&ActionKind::prefix, prefix);
}

bool within(config::NumberSpec const& range, double value) {
    return std::isfinite(value) && value >= range.min && value <= range.max && value > range.above &&
           value < range.below;
}

std::string range_text(config::NumberSpec const& range) {
    std::vector<std::string> parts;
    for (auto const& [sign, bound] :
         {std::pair{">=", range.min}, {">", range.above}, {"<=", range.max}, {"<", range.below}}) {
        if (std::isfinite(bound)) {
            parts.push_back(fmt::format("{} {}", sign, shortest(bound)));
        }
    }
    return join(parts, " and ");
}

Error cannot_be_set(SetParameter const& action, bool waveform) {
    return {ExitCode::usage,
            fmt::format("'{}' cannot be set to {} while a {} simulation runs", action.path, shortest(action.value),
                        waveform ? "waveform" : "phasor"),
            settable_paths(waveform) + " can"};
}

Result<Setting> setting_of(SetParameter const& action, bool waveform) {
    std::string_view const path = action.path;
    std::size_t const first = path.find('.'), last = path.rfind('.');
    if (first == std::string_view::npos || first == last) {
        return std::unexpected{cannot_be_set(action, waveform)};
    }
    ActionKind const* kind = kind_of_section(path.substr(0, first));
    Quantity const* quantity = kind == nullptr ? nullptr : kind->quantity(path.substr(last + 1), waveform);
    if (quantity == nullptr || !within(quantity->range, action.value)) {
        return std::unexpected{cannot_be_set(action, waveform)};
    }
    return Setting{kind, path.substr(first + 1, last - first - 1), quantity};
}

} // namespace gridspace::sim
