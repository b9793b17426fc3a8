// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/controls/control_config.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace gridspace::sim {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

std::vector<std::string> prefixes() {
    std::vector<std::string> out;
    for (ActionKind const& kind : action_kinds()) {
        out.emplace_back(kind.prefix);
    }
    return out;
}

/// "_kw" of "p_kw"; empty where the name of a quantity carries no unit.
std::string unit_suffix(std::string const& quantity) {
    std::size_t const at = quantity.rfind('_');
    return at == std::string::npos || config::unit_of_key(quantity).empty() ? "" : quantity.substr(at);
}

/// `from: ems` or `from: [ems, backup]`.
void read_sources(Fields& f, ControlConfig& c) {
    Node from;
    f.raw("from", from, {.doc = "processes that may steer it", .required = true});
    if (from.is_scalar()) {
        c.from.push_back({from.text, from.where});
    }
    for (Node const& item : from.items) {
        c.from.push_back({item.text, item.where});
    }
    bool const named = std::all_of(c.from.begin(), c.from.end(), [](Ref const& r) { return !r.empty(); });
    if (f.has("from") && (c.from.empty() || !named)) {
        f.error("from", "`from` names no process", "a process, or a list of processes");
    }
}

void read_keys(Fields& f, ControlConfig& c) {
    read_sources(f, c);
    if (c.quantity.empty()) {
        f.references("commands", c.commands,
                     {.doc = "those that are allowed; without it, all that the element follows"});
        return;
    }
    std::string const unit = unit_suffix(c.quantity);
    f.number("low" + unit, c.low, {.doc = "the lowest value that is obeyed"});
    f.number("high" + unit, c.high, {.doc = "the highest value that is obeyed"});
    f.number("ramp" + unit + "_per_s", c.ramp_per_s, {.doc = "how fast the quantity moves", .above = 0});
    f.number("hold_s", c.hold_s, {.doc = "how long the last value holds when nothing new comes", .min = 0});
    f.number("then", c.then, {.doc = "the value after that"});
    if (c.hold_s.has_value() != c.then.has_value()) {
        f.error("",
                fmt::format("'{}' has {}", c.path.name, c.then ? "`then` without `hold_s`" : "`hold_s` without `then`"),
                "the value after a time, and that time, go together");
    }
    if (c.low && c.high && *c.low > *c.high) {
        f.error("low" + unit, fmt::format("nothing lies between {} and {}", shortest(*c.low), shortest(*c.high)));
    }
    if (c.then && ((c.low && *c.then < *c.low) || (c.high && *c.then > *c.high))) {
        f.error("then", fmt::format("{} is outside of what may be asked for", shortest(*c.then)));
    }
}

/// The path of an entry; nothing when it leads nowhere in any network.
std::optional<ControlConfig> entry_of(Node::Entry const& entry, Diagnostics& diagnostics) {
    auto const wrong = [&](std::string message, std::string hint) {
        diagnostics.error(entry.where, std::move(message), std::move(hint), static_cast<int>(entry.key.size()));
        return std::nullopt;
    };
    std::vector<std::string> const parts = split(entry.key, '.');
    if (parts.size() != 2 && parts.size() != 3) {
        return wrong(fmt::format("'{}' is nothing to be steered", entry.key),
                     "expected kind.element.quantity (battery.BAT1.p_kw), or kind.element for commands (breaker.CB1)");
    }
    ControlConfig c;
    c.path = {entry.key, entry.where};
    c.kind = kind_of_prefix(parts[0]);
    c.element = parts[1];
    c.quantity = parts.size() == 3 ? parts[2] : "";
    if (c.kind == nullptr) {
        return wrong(fmt::format("'{}': there is no kind of element '{}' that can be steered", entry.key, parts[0]),
                     spelling_hint(parts[0], prefixes()));
    }
    if (!entry.value.is_map()) {
        return wrong(fmt::format("'{}' is {}", entry.key, config::describe(entry.value)),
                     "expected {from: PROCESS, ...}");
    }
    return c;
}

class Check {
  public:
    Check(std::vector<ControlConfig> const& all, Network const& network, bool waveform, Diagnostics& diagnostics)
        : all_{all}, n_{network}, waveform_{waveform}, diagnostics_{diagnostics} {}

    void operator()(ControlConfig const& c) {
        std::vector<std::string> const names = c.kind->names(n_);
        if (!c.is_pattern() && std::find(names.begin(), names.end(), c.element) == names.end()) {
            return wrong(c, fmt::format("there is no {} '{}'", c.kind->word, c.element),
                         spelling_hint(c.element, names, fmt::format("the network has no {}", c.kind->word)));
        }
        if (c.quantity.empty() ? !commands(c) : !quantity(c)) {
            return;
        }
        std::vector<std::string> const elements = elements_of(c, all_, n_, waveform_);
        if (elements.empty()) {
            return wrong(c, fmt::format("no {} can be steered so", c.kind->word),
                         "an element that is named goes before a pattern");
        }
        for (std::string const& element : elements) {
            auto const [it, first] =
                taken_.try_emplace({fmt::format("{}.{}", c.kind->prefix, element), c.quantity}, &c);
            if (!first) {
                return wrong(c,
                             fmt::format("'{}' is about {} '{}' as well", it->second->path.name, c.kind->word, element),
                             "one entry for each; a name goes before a pattern");
            }
        }
    }

  private:
    void wrong(ControlConfig const& c, std::string const& what, std::string hint) {
        diagnostics_.error(c.path.where, fmt::format("control '{}': {}", c.path.name, what), std::move(hint),
                           static_cast<int>(c.path.name.size()));
    }

    bool quantity(ControlConfig const& c) {
        Quantity const* q = c.kind->quantity(c.quantity, waveform_);
        if (q == nullptr) {
            wrong(c,
                  fmt::format("'{}' of a {} cannot be set in a run with {}", c.quantity, c.kind->word,
                              waveform_ ? "waveforms" : "phasors"),
                  spelling_hint(c.quantity, c.kind->quantity_names(waveform_), "nothing of it can"));
            return false;
        }
        if (auto const refusal = c.is_pattern() ? std::nullopt : refusal_of(n_, *c.kind, c.element, *q, waveform_)) {
            wrong(c, std::string{refusal->why}, std::string{refusal->hint});
            return false;
        }
        std::vector<std::string> const elements = elements_of(c, all_, n_, waveform_);
        auto const range = range_of(n_, *c.kind, elements.empty() ? "" : elements.front(), *q, waveform_);
        for (auto const& bound : {c.low, c.high, c.then}) {
            if (bound && !within(range, *bound)) {
                wrong(c, fmt::format("{} is a value that a {} cannot have", shortest(*bound), c.kind->word),
                      fmt::format("expected {}", range_text(range)));
                return false;
            }
        }
        return true;
    }

    bool commands(ControlConfig const& c) {
        std::vector<std::string> followed;
        for (CommandUse const& use : c.kind->commands) {
            if (waveform_ ? use.in_waveforms : use.in_phasors) {
                followed.emplace_back(kCommands[static_cast<std::size_t>(use.command)]);
            }
        }
        if (followed.empty()) {
            wrong(c, fmt::format("a {} follows no command", c.kind->word), "name a quantity: kind.element.quantity");
            return false;
        }
        for (Ref const& command : c.commands) {
            if (std::find(followed.begin(), followed.end(), command.name) == followed.end()) {
                diagnostics_.error(command.where,
                                   fmt::format("control '{}': a {} does not follow the command '{}'", c.path.name,
                                               c.kind->word, command.name),
                                   spelling_hint(command.name, followed), static_cast<int>(command.name.size()));
            }
        }
        return true;
    }

    std::vector<ControlConfig> const& all_;
    Network const& n_;
    bool waveform_;
    Diagnostics& diagnostics_;
    std::map<std::pair<std::string, std::string>, ControlConfig const*> taken_;
};

} // namespace

std::vector<ControlConfig> read_controls(Node const& controls, Diagnostics& diagnostics) {
    std::vector<ControlConfig> out;
    if (controls.is_null()) {
        return out;
    }
    if (!controls.is_map()) {
        diagnostics.error(controls.where, fmt::format("controls is {}", config::describe(controls)),
                          "expected a map from what is steered: {battery.BAT1.p_kw: {from: ems}}");
        return out;
    }
    for (Node::Entry const& entry : controls.entries) {
        if (entry.value.is_null()) {
            continue; // taken away by a file that lies on another
        }
        if (auto c = entry_of(entry, diagnostics)) {
            config::read_fields(entry.value, "simulation.controls." + entry.key, diagnostics,
                                [&](Fields& f) { read_keys(f, *c); });
            out.push_back(std::move(*c));
        }
    }
    return out;
}

void check_controls(std::vector<ControlConfig> const& controls, Network const& network, bool waveform,
                    Diagnostics& diagnostics) {
    Check check{controls, network, waveform, diagnostics};
    for (ControlConfig const& control : controls) {
        check(control);
    }
}

std::vector<std::string> elements_of(ControlConfig const& c, std::vector<ControlConfig> const& all,
                                     Network const& network, bool waveform) {
    std::vector<std::string> out;
    Quantity const* quantity = c.quantity.empty() ? nullptr : c.kind->quantity(c.quantity, waveform);
    for (std::string& name : c.kind->names(network)) {
        if (!c.is_pattern()) {
            if (name == c.element) {
                out.push_back(std::move(name));
            }
            continue;
        }
        bool const named = std::any_of(all.begin(), all.end(), [&](ControlConfig const& other) {
            return other.kind == c.kind && other.quantity == c.quantity && other.element == name;
        });
        bool const refused = quantity != nullptr && refusal_of(network, *c.kind, name, *quantity, waveform).has_value();
        if (!named && !refused && matches_glob(c.element, name)) {
            out.push_back(std::move(name));
        }
    }
    return out;
}

} // namespace gridspace::sim
