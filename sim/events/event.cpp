// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/events/event.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim {

using config::Fields;

void describe(Fields& f, Event& e) {
    f.fraction("at_s", e.at_s, {.doc = "simulated time", .required = true, .min = 0});
    config::Node set;
    f.raw("set", set, {.doc = "parameters of the network or of `impairments:` by path, and their new values"});
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
    f.references("open", e.open, {.doc = "breakers and switched elements to open"});
    f.references("close", e.close, {.doc = "breakers and switched elements to close"});
    f.object("apply_fault", {.doc = "short circuit on a line or at a bus"}, [&](Fields& g) {
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
    f.fraction("clear_after_ms", e.clear_after_ms, {.doc = "the fault clears by itself after so long", .above = 0});
    f.reference("disconnect", e.disconnect, {.doc = "element taken out of service"});
    f.references("fail_to_open", e.fail_to_open,
                 {.doc = "breakers that stay closed from then on, whatever opens them"});
    f.reference("desynchronise", e.desynchronise, {.doc = "merging unit that loses its clock: smpSynch becomes 0"});
    f.integer("shift_samples", e.shift_samples,
              {.doc = "desynchronise: how far its counter runs ahead of the samples", .min = -4800, .max = 4800});
    f.reference("resynchronise", e.resynchronise, {.doc = "merging unit whose clock is right again"});
    f.reference("kill", e.kill, {.doc = "process killed (SIGKILL)"});
    f.reference("pause", e.pause, {.doc = "process stopped (SIGSTOP)"});
    f.reference("resume", e.resume, {.doc = "process continued (SIGCONT)"});
    f.reference("restart", e.restart, {.doc = "process killed and started again"});
    constexpr std::string_view kDeeds[] = {"set",        "open",         "close",         "apply_fault",
                                           "disconnect", "fail_to_open", "desynchronise", "resynchronise",
                                           "kill",       "pause",        "resume",        "restart"};
    if (std::none_of(std::begin(kDeeds), std::end(kDeeds), [&](std::string_view deed) { return f.has(deed); })) {
        f.error("", fmt::format("event '{}' does nothing", e.name.name),
                "one of: set, open, close, apply_fault, disconnect, fail_to_open, desynchronise, resynchronise, kill, "
                "pause, resume, restart");
    }
    if (e.shift_samples != 0 && e.desynchronise.empty()) {
        f.error("shift_samples", fmt::format("event '{}' desynchronises nothing", e.name.name),
                "it belongs to `desynchronise: PROCESS`");
    }
    if (e.clear_after_ms && !e.fault) {
        f.error("clear_after_ms", fmt::format("event '{}' has no fault to clear", e.name.name));
    }
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
        for (Ref const& breaker : e.open) {
            add(*e.at_s, SwitchBreaker{breaker.name, false});
        }
        for (Ref const& breaker : e.close) {
            add(*e.at_s, SwitchBreaker{breaker.name, true});
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

template <class T>
std::vector<std::string> names_of(std::vector<T> const& elements) {
    std::vector<std::string> names;
    for (T const& element : elements) {
        names.push_back(element.name.name);
    }
    return names;
}

/// A path of `set:` must lead to something that the solver can change while it runs.
void check_set(Event const& e, Ref const& path, Network const& n, bool waveform, config::Diagnostics& diagnostics) {
    struct Section {
        std::string name;
        std::vector<std::string> elements, parameters;
    };
    std::vector<Section> sections;
    for_each_kind(n, [&]<class T>(std::vector<T> const& elements) {
        Section section{std::string{T::kKind.section}, names_of(elements), {}};
        for (Quantity const& q : T::kKind.settable) {
            if (waveform || q.in_phasors) {
                section.parameters.emplace_back(q.name);
            }
        }
        if (!section.parameters.empty()) {
            sections.push_back(std::move(section));
        }
    });
    sections.push_back({"machines", names_of(n.machines), {"p_kw", "voltage_setpoint_pu"}});
    if (waveform) {
        sections.push_back({"sources", names_of(n.sources), {"voltage_pu", "frequency_hz"}});
    }
    std::vector<std::string> const parts = split(path.name, '.');
    auto const wrong = [&](std::string message, std::string const& word, std::vector<std::string> const& words) {
        diagnostics.error(path.where, std::move(message), spelling_hint(word, words, "the network has none"),
                          static_cast<int>(path.name.size()));
    };
    if (parts.size() != 3) {
        diagnostics.error(path.where, fmt::format("event '{}' sets '{}'", e.name.name, path.name),
                          "expected section.element.parameter, for example loads.AC3.p_kw",
                          static_cast<int>(path.name.size()));
        return;
    }
    std::vector<std::string> section_names;
    for (Section const& s : sections) {
        section_names.push_back(s.name);
    }
    auto const section =
        std::find_if(sections.begin(), sections.end(), [&](Section const& s) { return s.name == parts[0]; });
    if (section == sections.end()) {
        wrong(fmt::format("event '{}' sets '{}': '{}' cannot be changed in a run", e.name.name, path.name, parts[0]),
              parts[0], section_names);
        return;
    }
    auto const among = [](std::vector<std::string> const& words, std::string const& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    if (!among(section->elements, parts[1])) {
        wrong(
            fmt::format("event '{}' sets '{}', and there is no '{}' in {}", e.name.name, path.name, parts[1], parts[0]),
            parts[1], section->elements);
    }
    if (!among(section->parameters, parts[2])) {
        wrong(fmt::format("event '{}' sets '{}': '{}' cannot be changed in a run", e.name.name, path.name, parts[2]),
              parts[2], section->parameters);
    }
    for (OnePort const* element : one_ports(n)) {
        if (element->kind().section != parts[0] || element->name.name != parts[1]) {
            continue;
        }
        if (auto const refusal = element->refuses(parts[2])) {
            diagnostics.error(path.where,
                              fmt::format("event '{}' sets '{}', but {}", e.name.name, path.name, refusal->why),
                              std::string{refusal->hint}, static_cast<int>(path.name.size()));
        }
    }
}

/// An element at one bus with a switch of its own.
bool is_switched_element(Network const& n, std::string_view name) {
    std::vector<OnePort const*> const elements = one_ports(n);
    return std::any_of(elements.begin(), elements.end(),
                       [&](OnePort const* e) { return e->kind().switched && e->name.name == name; });
}

} // namespace

void check_events(std::vector<Event> const& events, Network const& n, bool waveform, config::Diagnostics& diagnostics) {
    auto const must = [&](auto const& elements, Ref const& ref, std::string_view kind, Event const& e) {
        if (ref.empty() || find(elements, ref.name) != nullptr) {
            return;
        }
        std::vector<std::string> names;
        for (auto const& element : elements) {
            names.push_back(element.name.name);
        }
        diagnostics.error(
            ref.where, fmt::format("event '{}' names the {} '{}', which does not exist", e.name.name, kind, ref.name),
            spelling_hint(ref.name, names, fmt::format("the network has no {}", kind)),
            static_cast<int>(ref.name.size()));
    };
    for (Event const& e : events) {
        for (std::vector<Ref> const* switched : {&e.open, &e.close}) {
            for (Ref const& b : *switched) {
                if (!is_switched_element(n, b.name)) {
                    must(n.breakers, b, "breaker", e);
                }
            }
        }
        for (Ref const& b : e.fail_to_open) {
            must(n.breakers, b, "breaker", e);
        }
        must(n.lines, e.fault_line, "line", e);
        must(n.buses, e.fault_bus, "bus", e);
        for (auto const& [path, value] : e.set) {
            check_set(e, path, n, waveform, diagnostics);
        }
    }
}

} // namespace gridspace::sim
