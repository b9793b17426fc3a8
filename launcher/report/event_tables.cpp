// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/event_tables.hpp"

#include "common/text.hpp"
#include "launcher/judge/signal_rows.hpp"
#include "launcher/report/relay_settings_table.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;

/// "fault: apply_fault (line: TL2, position_percent: 50 %, type: 3ph_g)": an event of the timeline by its name and by
/// what it did. What says when it was is left out.
std::string what_it_did(Node const& scenario, std::string const& name) {
    Node const* const events = scenario.find("events");
    Node const* const event = events == nullptr ? nullptr : events->find(name);
    std::vector<std::string> out;
    for (Node::Entry const& action :
         event == nullptr || !event->is_map() ? std::vector<Node::Entry>{} : event->entries) {
        if (action.key == "at_s" || action.key == "at") {
            continue;
        }
        std::vector<std::string> settings;
        std::ranges::transform(action.value.entries, std::back_inserter(settings),
                               [](Node::Entry const& one) { return setting_text(one.key, one.value); });
        out.push_back(action.value.is_map() ? fmt::format("{} ({})", action.key, join(settings, ", "))
                                            : setting_text(action.key, action.value));
    }
    return out.empty() ? name : fmt::format("{}: {}", name, join(out, ", "));
}

/// With rows for what breakers and fuses did: "opened" when the last pole has parted.
std::vector<LoggedEvent> with_breakers(Results const& r) {
    std::vector<LoggedEvent> out = r.events;
    for (auto const& [name, series] : r.signals) {
        bool const position = matches_glob("breaker.*.position", name) || matches_glob("fuse.*.position", name);
        std::size_t const begin = name.find('.') + 1;
        for (std::size_t i = 1; position && i < series.values.size(); ++i) {
            double const now = series.values[i];
            if (now != series.values[i - 1] && (now == kOpenPosition || now == kClosedPosition)) {
                bool const open = now == kOpenPosition;
                out.push_back({static_cast<double>(series.times_ns[i]) / 1e9,
                               name.substr(begin, name.rfind('.') - begin), open ? "opened" : "closed",
                               open ? "the last pole has parted" : ""});
            }
        }
    }
    std::ranges::stable_sort(out, {}, &LoggedEvent::time_s);
    return out;
}

ReportTable table_of(std::vector<LoggedEvent> const& events, Node const& scenario) {
    ReportTable t{"What happened", {"time", "", "source", "event", "what"}, {}};
    auto const cause = std::ranges::find(events, "event", &LoggedEvent::event);
    if (cause != events.end()) {
        t.header[1] = fmt::format("since {}, ms", cause->text);
    }
    for (LoggedEvent const& e : events) {
        bool const later = cause != events.end() && e.time_s >= cause->time_s;
        bool const of_timeline = e.event == "event";
        t.rows.push_back({fmt::format("{:.4f}&nbsp;s", e.time_s),
                          later ? fmt::format("{:+.2f}", (e.time_s - cause->time_s) * 1e3) : "",
                          of_timeline ? "scenario" : escape_markup(e.source), escape_markup(e.event),
                          escape_markup(of_timeline ? what_it_did(scenario, e.text) : e.text)});
    }
    return t;
}

} // namespace

ReportTable event_table(Results const& r, Node const& scenario) {
    return table_of(with_breakers(r), scenario);
}

ReportTable main_events(Results const& r, Node const& scenario) {
    static std::set<std::string> const kMain{"event",   "pickup", "operate", "trip",       "command",
                                             "release", "opened", "closed",  "run_failed", "run_stopped"};
    std::vector<LoggedEvent> const all = with_breakers(r);
    std::vector<LoggedEvent> few;
    std::ranges::copy_if(all, std::back_inserter(few), [](LoggedEvent const& e) { return kMain.contains(e.event); });
    ReportTable t = table_of(few, scenario);
    t.note =
        fmt::format("{} of {} events: those of the timeline, pickups, trips, commands and breakers; all are in the "
                    "table near the end.",
                    few.size(), all.size());
    return t;
}

} // namespace gridspace::launcher
