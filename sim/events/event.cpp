// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/events/event.hpp"

#include "common/text.hpp"
#include "sim/actions/action_table.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::sim {

using config::Fields;

namespace {

constexpr EventAction kActions[] = {
    {"set", "quantities of the table below, or keys of `impairments:`, by path, and their new values", "`set_points`"},
    {"open", "breakers and switched elements to open", "`COMMAND_OPEN`"},
    {"close", "breakers and switched elements to close", "`COMMAND_CLOSE`"},
    {"apply_fault", "short circuit on a line or at a bus"},
    {"disconnect", "element taken out of service", "`COMMAND_DISCONNECT`"},
    {"connect", "element put back into service", "`COMMAND_CONNECT`"},
    {"start", "converters that give their power again", "`COMMAND_START`"},
    {"stop", "converters that stand by: connected, and without current", "`COMMAND_STOP`"},
    {"fail_to_open", "breakers that stay closed from then on, whatever opens them"},
    {"reset", "breakers that failed to open, and work again", "`COMMAND_RESET`"},
    {"mode", "elements and how their regulators work from then on: `{G1: droop}`", "`COMMAND_MODE`"},
    {"desynchronise", "merging unit that loses its clock: smpSynch becomes 0"},
    {"resynchronise", "merging unit whose clock is right again"},
    {"kill", "process killed (SIGKILL)"},
    {"pause", "process stopped (SIGSTOP)"},
    {"resume", "process continued (SIGCONT)"},
    {"restart", "process killed and started again"}};

constexpr config::Spec what(std::string_view key) {
    for (EventAction const& action : kActions) {
        if (action.key == key) {
            return {.doc = action.doc};
        }
    }
    return {};
}

/// The commands of an event, and to whom.
std::array<std::pair<Command, std::vector<Ref> const*>, 5> commands_of(Event const& e) {
    return {{{Command::open, &e.open},
             {Command::close, &e.close},
             {Command::start, &e.start},
             {Command::stop, &e.stop},
             {Command::reset, &e.reset}}};
}

void describe_settings(Fields& f, Event& e) {
    config::Node set;
    f.raw("set", set, what("set"));
    for (config::Node::Entry const& entry : set.entries) {
        bool const of_a_cable = entry.key.starts_with("impairments.");
        bool const flag =
            of_a_cable && entry.value.is_scalar() && (entry.value.text == "true" || entry.value.text == "false");
        if (auto const value =
                flag ? std::optional{entry.value.text == "true" ? 1.0 : 0.0} : config::number_of(entry.value)) {
            (of_a_cable ? e.set_impairments : e.set).emplace_back(Ref{entry.key, entry.where}, *value);
        } else {
            f.error("set", fmt::format("'{}' is set to {}", entry.key, config::describe(entry.value)),
                    "expected a number");
        }
    }
}

void describe_fault(Fields& f, Event& e) {
    f.object("apply_fault", what("apply_fault"), [&](Fields& g) {
        ApplyFault& fault = e.fault.emplace();
        fault.name = e.name.name;
        g.reference("line", e.fault_line, {.doc = "the faulted line"});
        g.reference("bus", e.fault_bus, {.doc = "the faulted bus"});
        g.number("position_percent", fault.position_percent,
                 {.doc = "place on the line, from its `from` end", .min = 0, .max = 100});
        g.choice<FaultType>("type", fault.type,
                            {{"3ph_g", FaultType::three_phase_ground},
                             {"3ph", FaultType::three_phase},
                             {"1ph_g", FaultType::phase_ground},
                             {"2ph", FaultType::phase_phase},
                             {"2ph_g", FaultType::phase_phase_ground}},
                            {.doc = "which conductors", .required = true});
        g.number("resistance_ohm", fault.resistance_ohm, {.doc = "per phase", .min = 0});
        fault.line = e.fault_line.name;
        fault.bus = e.fault_bus.name;
        if (e.fault_line.empty() == e.fault_bus.empty()) {
            g.error("", fmt::format("event '{}': a fault is on a line or at a bus", e.name.name),
                    "give one of `line` and `bus`");
        }
    });
}

void describe_modes(Fields& f, Event& e) {
    config::Node mode;
    f.raw("mode", mode, what("mode"));
    for (config::Node::Entry const& entry : mode.entries) {
        e.mode.emplace_back(Ref{entry.key, entry.where}, entry.value.text);
    }
    if (f.has("mode") && !mode.is_map()) {
        f.error("mode", fmt::format("`mode` is {}", config::describe(mode)),
                "expected elements and their modes: {G1: droop}");
    }
}

void check(Fields& f, Event const& e) {
    if (std::none_of(std::begin(kActions), std::end(kActions), [&](EventAction const& a) { return f.has(a.key); })) {
        std::vector<std::string> keys;
        for (EventAction const& action : kActions) {
            keys.emplace_back(action.key);
        }
        f.error("", fmt::format("event '{}' does nothing", e.name.name), "one of: " + join(keys, ", "));
    }
    if (e.shift_samples != 0 && e.desynchronise.empty()) {
        f.error("shift_samples", fmt::format("event '{}' desynchronises nothing", e.name.name),
                "it belongs to `desynchronise: PROCESS`");
    }
    if (e.clear_after_ms && !e.fault) {
        f.error("clear_after_ms", fmt::format("event '{}' has no fault to clear", e.name.name));
    }
}

} // namespace

std::span<EventAction const> event_actions() {
    return kActions;
}

void describe(Fields& f, Event& e) {
    f.fraction("at_s", e.at_s, {.doc = "simulated time", .required = true, .min = 0});
    describe_settings(f, e);
    f.references("open", e.open, what("open"));
    f.references("close", e.close, what("close"));
    describe_fault(f, e);
    f.fraction("clear_after_ms", e.clear_after_ms, {.doc = "the fault clears by itself after so long", .above = 0});
    f.reference("disconnect", e.disconnect, what("disconnect"));
    f.reference("connect", e.connect, what("connect"));
    f.references("start", e.start, what("start"));
    f.references("stop", e.stop, what("stop"));
    f.references("fail_to_open", e.fail_to_open, what("fail_to_open"));
    f.references("reset", e.reset, what("reset"));
    describe_modes(f, e);
    f.reference("desynchronise", e.desynchronise, what("desynchronise"));
    f.integer("shift_samples", e.shift_samples,
              {.doc = "desynchronise: how far its counter runs ahead of the samples", .min = -4800, .max = 4800});
    f.reference("resynchronise", e.resynchronise, what("resynchronise"));
    f.reference("kill", e.kill, what("kill"));
    f.reference("pause", e.pause, what("pause"));
    f.reference("resume", e.resume, what("resume"));
    f.reference("restart", e.restart, what("restart"));
    check(f, e);
}

void describe_events(Fields& parent, std::vector<Event>& events) {
    parent.map("events", {.doc = "what happens, on one timeline"}, [&](Ref const& name, Fields& f) {
        Event event;
        event.name = name;
        describe(f, event);
        events.push_back(std::move(event));
    });
}

std::vector<TimedAction> timeline(std::vector<Event> const& events) {
    std::vector<TimedAction> out;
    for (Event const& e : events) {
        if (!e.at_s) {
            continue;
        }
        auto const add = [&](Rational at, Action action) { out.push_back({at, std::move(action), e.name.name}); };
        for (auto const& [path, value] : e.set) {
            add(*e.at_s, SetParameter{path.name, value});
        }
        for (auto const& [command, elements] : commands_of(e)) {
            for (Ref const& element : *elements) {
                add(*e.at_s, action_of(command, element.name));
            }
        }
        for (auto const& [element, mode] : e.mode) {
            add(*e.at_s, SetMode{element.name, mode});
        }
        if (e.fault) {
            add(*e.at_s, *e.fault);
            if (e.clear_after_ms) {
                add(*e.at_s + *e.clear_after_ms / Rational{1000}, ClearFault{e.name.name});
            }
        }
        if (!e.disconnect.empty()) {
            add(*e.at_s, Disconnect{e.disconnect.name});
        }
        if (!e.connect.empty()) {
            add(*e.at_s, Connect{e.connect.name});
        }
    }
    std::stable_sort(out.begin(), out.end(), [](auto const& a, auto const& b) { return a.at_s < b.at_s; });
    return out;
}

std::vector<StuckBreaker> stuck_breakers(std::vector<Event> const& events) {
    std::vector<StuckBreaker> out;
    for (Event const& e : events) {
        for (Ref const& breaker : e.fail_to_open) {
            if (e.at_s) {
                out.push_back({*e.at_s, breaker.name});
            }
        }
    }
    return out;
}

namespace {

/// A path of `set:` must lead to something that the solver can change while it runs, and to a value that it can have.
void check_set(Event const& e, Ref const& path, double value, Network const& n, bool waveform,
               config::Diagnostics& diagnostics) {
    auto const wrong = [&](std::string_view what, std::string hint) {
        diagnostics.error(path.where, fmt::format("event '{}' sets '{}'{}", e.name.name, path.name, what),
                          std::move(hint), static_cast<int>(path.name.size()));
    };
    auto const unknown = [&](std::string_view what, std::string const& word, std::vector<std::string> const& words) {
        wrong(what, spelling_hint(word, words, "the network has none"));
    };
    std::vector<std::string> const parts = split(path.name, '.');
    if (parts.size() != 3) {
        return wrong("", "expected section.element.parameter, for example loads.AC3.p_kw");
    }
    ActionKind const* kind = kind_of_section(parts[0]);
    if (kind == nullptr || kind->quantity_names(waveform).empty()) {
        std::vector<std::string> sections;
        for (ActionKind const& one : action_kinds()) {
            if (!one.quantity_names(waveform).empty()) {
                sections.emplace_back(one.section);
            }
        }
        return unknown(fmt::format(": '{}' cannot be changed in a run", parts[0]), parts[0], sections);
    }
    std::vector<std::string> const names = kind->names(n);
    if (std::find(names.begin(), names.end(), parts[1]) == names.end()) {
        unknown(fmt::format(", and there is no '{}' in {}", parts[1], parts[0]), parts[1], names);
    }
    Quantity const* quantity = kind->quantity(parts[2], waveform);
    if (quantity == nullptr) {
        return unknown(fmt::format(": '{}' cannot be changed in a run", parts[2]), parts[2],
                       kind->quantity_names(waveform));
    }
    if (auto const refusal = refusal_of(n, *kind, parts[1], *quantity, waveform)) {
        wrong(fmt::format(", but {}", refusal->why), std::string{refusal->hint});
    }
    if (auto const range = range_of(n, *kind, parts[1], *quantity, waveform); !within(range, value)) {
        wrong(fmt::format(" to {}, which is out of range", shortest(value)),
              fmt::format("expected {}", range_text(range)));
    }
}

} // namespace

void check_events(std::vector<Event> const& events, Network const& n, bool waveform, config::Diagnostics& diagnostics) {
    auto const missing = [&](Ref const& ref, std::string_view kind, std::vector<std::string> const& names,
                             Event const& e) {
        diagnostics.error(
            ref.where, fmt::format("event '{}' names the {} '{}', which does not exist", e.name.name, kind, ref.name),
            spelling_hint(ref.name, names, fmt::format("the network has no {}", kind)),
            static_cast<int>(ref.name.size()));
    };
    auto const must = [&](auto const& elements, Ref const& ref, std::string_view kind, Event const& e) {
        if (ref.empty() || find(elements, ref.name) != nullptr) {
            return;
        }
        std::vector<std::string> names;
        for (auto const& element : elements) {
            names.push_back(element.name.name);
        }
        missing(ref, kind, names, e);
    };
    for (Event const& e : events) {
        for (auto const& [command, elements] : commands_of(e)) {
            for (Ref const& element : *elements) {
                if (follows(n, element.name, command, waveform)) {
                    continue;
                }
                if (command == Command::start || command == Command::stop) {
                    missing(element, "converter", names_that_follow(n, command, waveform), e);
                } else {
                    must(n.breakers, element, "breaker", e);
                }
            }
        }
        for (auto const& [element, mode] : e.mode) {
            if (auto const ok = check_mode(n, {element.name, mode}); !ok) {
                diagnostics.error(element.where, fmt::format("event '{}': {}", e.name.name, ok.error().message),
                                  ok.error().remedy, static_cast<int>(element.name.size()));
            }
        }
        for (Ref const& b : e.fail_to_open) {
            must(n.breakers, b, "breaker", e);
        }
        must(n.lines, e.fault_line, "line", e);
        must(n.buses, e.fault_bus, "bus", e);
        if (Line const* const line = find(n.lines, e.fault_line.name); waveform && e.fault && line != nullptr) {
            if (auto const refusal = line->refuses_fault(e.fault->position_percent)) {
                diagnostics.error(e.fault_line.where,
                                  fmt::format("event '{}' has a fault at {} % of line '{}', but {}", e.name.name,
                                              shortest(e.fault->position_percent), line->name.name, refusal->why),
                                  std::string{refusal->hint}, static_cast<int>(e.fault_line.name.size()));
            }
        }
        for (auto const& [path, value] : e.set) {
            check_set(e, path, value, n, waveform, diagnostics);
        }
    }
}

} // namespace gridspace::sim
