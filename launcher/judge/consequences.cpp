// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/consequences.hpp"

#include "launcher/judge/number_at.hpp"
#include "launcher/judge/protection_chain.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

namespace gridspace::launcher {
namespace {

using config::Node;

/// A trip that comes more than a sample of 4800 Hz behind that of the relay without a detector is late.
constexpr double kLateMs = 0.21;
constexpr double kServed = 0.5;
/// A trip or an opening so long after a fault is still its own.
constexpr double kBelongsWithinS = 0.5;
constexpr double kOpen = 1; ///< of a position, as IEC 61850-7-3 counts

/// What a load asks for: from an instant on, kW at 1 p.u. Nothing when a profile or an agent decides about it.
std::optional<std::map<std::int64_t, double>> demand(Node const& load, std::string const& name, Node const& scenario) {
    auto const p_kw = number_at(&load, "p_kw");
    if (!p_kw || load.find("scale") != nullptr) {
        return std::nullopt;
    }
    struct Change {
        double at_s{0};
        std::optional<double> p_kw;
        std::optional<bool> connected;
    };
    std::vector<Change> changes;
    if (Node const* events = scenario.find("events"); events != nullptr && events->is_map()) {
        for (Node::Entry const& event : events->entries) {
            auto const at_s = number_at(&event.value, "at_s");
            auto const names = [&](std::string_view key) {
                Node const* element = event.value.find(key);
                return element != nullptr && element->text == name;
            };
            if (at_s) {
                auto const set = number_at(event.value.find("set"), "loads." + name + ".p_kw");
                changes.push_back({*at_s, set,
                                   names("disconnect") ? std::optional{false}
                                   : names("connect")  ? std::optional{true}
                                                       : std::nullopt});
            }
        }
    }
    std::stable_sort(changes.begin(), changes.end(), [](auto const& a, auto const& b) { return a.at_s < b.at_s; });
    std::map<std::int64_t, double> out{{0, *p_kw}};
    double wanted = *p_kw;
    bool connected = true; // a load that the scenario takes away asks for nothing
    for (Change const& change : changes) {
        wanted = change.p_kw.value_or(wanted);
        connected = change.connected.value_or(connected);
        out[std::llround(change.at_s * 1e9)] = connected ? wanted : 0;
    }
    return out;
}

/// kW that the load does not get, at each instant at which its power was recorded.
std::vector<double> not_served(SignalSeries const& p_kw, std::map<std::int64_t, double> const& asked) {
    std::vector<double> out;
    for (std::size_t i = 0; i < p_kw.values.size(); ++i) {
        double const wanted = std::prev(asked.upper_bound(std::max<std::int64_t>(p_kw.times_ns[i], 0)))->second;
        out.push_back(p_kw.values[i] < kServed * wanted ? wanted - std::max(p_kw.values[i], 0.0) : 0);
    }
    return out;
}

void judge_loads(Consequences& out, Node const& scenario, Node const& network, SignalStore const& signals,
                 double end_s) {
    Node const* loads = network.find("loads");
    if (loads == nullptr || !loads->is_map()) {
        return;
    }
    std::map<std::int64_t, double> sum; ///< kW of all; the loads are recorded at the same instants
    for (Node::Entry const& load : loads->entries) {
        auto const p_kw = signals.find("load." + load.key + ".p_kw");
        auto const asked = demand(load.value, load.key, scenario);
        if (!asked || p_kw == signals.end() || p_kw->second.values.empty()) {
            out.unknown.push_back(load.key);
            continue;
        }
        Consequences::Load judged{load.key, asked->rbegin()->second, 0, 0};
        std::vector<double> const missing = not_served(p_kw->second, *asked);
        auto const& times = p_kw->second.times_ns;
        for (std::size_t i = 0; i < missing.size(); ++i) {
            double const until_ns = i + 1 < times.size() ? static_cast<double>(times[i + 1]) : end_s * 1e9;
            judged.not_served_wh += missing[i] * 1e3 * std::max(until_ns - static_cast<double>(times[i]), 0.0) / 3600e9;
            judged.most_not_served_kw = std::max(judged.most_not_served_kw, missing[i]);
            out.load_not_served_kw = std::max(out.load_not_served_kw, sum[times[i]] += missing[i]);
        }
        out.energy_not_served_wh += judged.not_served_wh;
        out.loads.push_back(std::move(judged));
    }
}

constexpr std::string_view kBreaker = "breaker.", kPosition = ".position";

/// Whether a breaker was open at some instant of the span; nothing when it was not recorded.
std::optional<bool> was_open(SignalStore const& signals, std::string const& breaker, double from_s, double to_s) {
    auto const found = signals.find(std::string{kBreaker} + breaker + std::string{kPosition});
    if (found == signals.end() || found->second.values.empty()) {
        return std::nullopt;
    }
    bool open = false; // what holds at the begin of the span, and what comes within
    for (std::size_t i = 0; i < found->second.values.size(); ++i) {
        double const at_s = 1e-9 * static_cast<double>(found->second.times_ns[i]);
        if (at_s <= from_s) {
            open = found->second.values[i] == kOpen;
        } else if (at_s <= to_s) {
            open = open || found->second.values[i] == kOpen;
        }
    }
    return open;
}

/// The relay decided to trip, and none of the breakers behind it opened: the message or the command was taken away.
bool did_not_open(std::vector<std::string> const& breakers, SignalStore const& signals, double fault_s) {
    bool recorded = false;
    for (std::string const& breaker : breakers) {
        auto const open = was_open(signals, breaker, fault_s, fault_s + kBelongsWithinS);
        if (open && *open) {
            return false;
        }
        recorded = recorded || open.has_value();
    }
    return recorded;
}

void judge_trips(Consequences& out, IntrusionScore const& score, Node const& scenario, SignalStore const& signals) {
    std::vector<ProtectionChain> const chains = protection_chains(scenario);
    for (IntrusionScore::Relay const& r : score.relays) {
        auto const chain = std::ranges::find(chains, r.relay, &ProtectionChain::relay);
        std::vector<std::string> const breakers =
            chain == chains.end() ? std::vector<std::string>{} : chain->breakers();
        out.faults += r.with.real_faults;
        out.lost += r.with.late_or_blocked;
        out.false_trips += r.with.false_trips;
        for (double const fault_s : r.faults_s) {
            auto const trip = std::find_if(r.trips_s.begin(), r.trips_s.end(),
                                           [&](double t) { return t >= fault_s && t <= fault_s + kBelongsWithinS; });
            if (trip != r.trips_s.end()) {
                out.slowest_trip_ms = std::max(out.slowest_trip_ms.value_or(0), 1e3 * (*trip - fault_s));
                out.lost += did_not_open(breakers, signals, fault_s) ? 1 : 0;
            }
        }
        out.compared += r.added_each_ms.size();
        out.late += static_cast<std::uint64_t>(std::count_if(r.added_each_ms.begin(), r.added_each_ms.end(),
                                                             [](double added) { return added > kLateMs; }));
    }
}

/// Breakers that opened although no fault was there and the scenario did not open them, whatever commanded it.
void judge_openings(Consequences& out, Node const& scenario, SignalStore const& signals) {
    Node const* events = scenario.find("events");
    auto const has_reason = [&](std::string const& breaker, double at_s) {
        if (events == nullptr || !events->is_map()) {
            return false;
        }
        return std::any_of(events->entries.begin(), events->entries.end(), [&](Node::Entry const& event) {
            auto const since_s = number_at(&event.value, "at_s");
            if (!since_s || at_s < *since_s || at_s > *since_s + kBelongsWithinS) {
                return false;
            }
            Node const* open = event.value.find("open");
            return event.value.find("apply_fault") != nullptr ||
                   (open != nullptr &&
                    (open->text == breaker || std::any_of(open->items.begin(), open->items.end(),
                                                          [&](Node const& name) { return name.text == breaker; })));
        });
    };
    for (auto const& [name, series] : signals) {
        if (!name.starts_with(kBreaker) || !name.ends_with(kPosition)) {
            continue;
        }
        std::string const breaker = name.substr(kBreaker.size(), name.size() - kBreaker.size() - kPosition.size());
        for (std::size_t i = 1; i < series.values.size(); ++i) {
            bool const opens = series.values[i] == kOpen && series.values[i - 1] != kOpen;
            if (opens && !has_reason(breaker, 1e-9 * static_cast<double>(series.times_ns[i]))) {
                out.opened_without_fault.push_back(breaker);
            }
        }
    }
}

} // namespace

bool is_disturbed(Node const& scenario) {
    auto const any = [&](char const* key, auto const& holds) {
        Node const* const node = scenario.find(key);
        return node != nullptr && node->is_map() && std::ranges::any_of(node->entries, holds);
    };
    return any("attacks", [](Node::Entry const&) { return true; }) ||
           any("processes", // what `impairments:` stand for
               [](Node::Entry const& process) {
                   Node const* const program = process.value.find("program");
                   return program != nullptr && program->text == "gridspace-link";
               }) ||
           any("events", [](Node::Entry const& event) {
               return event.value.find("kill") != nullptr || event.value.find("pause") != nullptr ||
                      event.value.find("restart") != nullptr;
           });
}

Consequences find_consequences(IntrusionScore const& score, Node const& scenario, Node const& network,
                               SignalStore const& signals, double end_s) {
    Consequences out;
    judge_trips(out, score, scenario, signals);
    judge_openings(out, scenario, signals);
    judge_loads(out, scenario, network, signals, end_s);
    AttackSpans spans{scenario};
    for (IntrusionRecording::Label const& label : score.recording.labels) {
        spans.add(label);
    }
    out.alarms = score_alarms(spans.all(), raised_alarms(signals, end_s), end_s);
    return out;
}

std::vector<ConsequenceSignal> consequence_signals(Consequences const& c) {
    auto const count = [](auto n) { return static_cast<double>(n); };
    auto const known = [&](double value) { return c.loads.empty() ? std::nullopt : std::optional{value}; };
    return {{"consequence.trips_lost", "", count(c.lost)},
            {"consequence.trips_late", "", count(c.late)},
            {"consequence.trips_false", "", count(c.false_trips)},
            {"consequence.openings_false", "", count(c.opened_without_fault.size())},
            {"consequence.slowest_trip_ms", "ms", c.slowest_trip_ms},
            {"consequence.load_not_served_kw", "kW", known(c.load_not_served_kw)},
            {"consequence.energy_not_served_wh", "Wh", known(c.energy_not_served_wh)}};
}

void add_consequence_signals(Consequences const& c, double end_s, SignalStore& signals) {
    auto const add = [&](std::string const& name, std::string const& unit, double value) {
        signals[name] = {unit, {std::llround(end_s * 1e9)}, {value}};
    };
    for (ConsequenceSignal const& signal : consequence_signals(c)) {
        if (signal.value) {
            add(signal.name, signal.unit, *signal.value);
        }
    }
    for (AlarmScore::Attack const& attack : c.alarms.attacks) {
        add("score." + attack.span.attack + ".alarmed", "", attack.delay_ms ? 1 : 0);
        if (attack.delay_ms) {
            add("score." + attack.span.attack + ".alarm_ms", "ms", *attack.delay_ms);
        }
    }
}

} // namespace gridspace::launcher
