// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/summary.hpp"

#include "common/config/yaml.hpp"
#include "common/lateness_json.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/report/wire_timing_page.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;
using Status = ExpectationResult::Status;

std::string_view name_of(Status status) {
    switch (status) {
    case Status::passed:
        return "pass";
    case Status::failed:
        return "FAIL";
    case Status::shown:
        return "shown";
    case Status::not_applicable:
        break;
    }
    return "n/a";
}

Json number_or_null(std::optional<double> const& v) {
    return v ? Json(*v) : Json(nullptr);
}

std::string paint(std::string_view text, Status status, bool colour) {
    if (!colour || status == Status::shown || status == Status::not_applicable) {
        return std::string{text};
    }
    return fmt::format("\x1b[{}m{}\x1b[0m", status == Status::passed ? "32" : "1;31", text);
}

std::string value_text(ExpectationResult const& e) {
    if (!e.value) {
        return "-";
    }
    if (e.verb == "always" || e.verb == "never" || e.verb == "eventually") {
        return *e.value != 0 ? "holds" : "does not hold";
    }
    return fmt::format("{:.6g}{}{}", *e.value, e.unit.empty() ? "" : " ", e.unit);
}

Json consequences_json(Consequences const& c) {
    Json alarms = Json::object();
    for (AlarmScore::Attack const& attack : c.alarms.attacks) {
        alarms[attack.span.attack] =
            attack.delay_ms ? Json{{"by", attack.by}, {"delay_ms", *attack.delay_ms}} : Json(nullptr);
    }
    bool const known = !c.loads.empty();
    return {{"faults", c.faults},
            {"trips_lost", c.lost},
            {"trips_late", c.compared == 0 ? Json(nullptr) : Json(c.late)},
            {"trips_false", c.false_trips},
            {"slowest_trip_ms", number_or_null(c.slowest_trip_ms)},
            {"opened_without_fault", c.opened_without_fault},
            {"load_not_served_kw", known ? Json(c.load_not_served_kw) : Json(nullptr)},
            {"energy_not_served_wh", known ? Json(c.energy_not_served_wh) : Json(nullptr)},
            {"alarms", alarms}};
}

} // namespace

std::string summary_json(Results const& r) {
    Json expectations = Json::array(), processes = Json::array(), topics = Json::array();
    for (ExpectationResult const& e : r.expectations) {
        expectations.push_back(
            {{"name", e.name},
             {"verb", e.verb},
             {"value", number_or_null(e.value)},
             {"unit", e.unit},
             {"low", number_or_null(e.band.low)},
             {"high", number_or_null(e.band.high)},
             {"pass", e.status == Status::passed || e.status == Status::failed ? Json(e.status == Status::passed)
                                                                               : Json(nullptr)},
             {"advisory", e.advisory},
             {"detail", e.detail}});
    }
    for (Results::ProcessRow const& p : r.processes) {
        processes.push_back({{"name", p.name},
                             {"program", p.program},
                             {"host", p.host},
                             {"exit", p.code},
                             {"end", p.end},
                             {"cpu_s", p.cpu_s}});
    }
    for (Results::Topic const& t : r.topics) {
        topics.push_back({{"name", t.topic}, {"type", t.type}, {"samples", t.samples}, {"processes", t.processes}});
    }
    Json summary{{"scenario", r.scenario},
                 {"mode", r.mode},
                 {"simulated_s", r.outcome.simulated_s},
                 {"wall_s", r.outcome.wall_s},
                 {"exit", r.exit_code()},
                 {"cause", r.outcome.cause},
                 {"overruns", r.outcome.overruns},
                 {"ticks", r.outcome.ticks ? to_json(*r.outcome.ticks) : Json(nullptr)},
                 {"scheduling", r.scheduling},
                 {"idle_processors", r.idle_processors},
                 {"notes", r.notes},
                 {"expectations", expectations},
                 {"processes", processes},
                 {"topics", topics},
                 {"comtrade", r.comtrade}};
    if (r.consequences) {
        summary["consequences"] = consequences_json(*r.consequences);
    }
    config::Diagnostics unread;
    auto const scenario = config::load_yaml(r.folder / "scenario.resolved.yaml", unread);
    if (auto const timing = scenario ? measure_wire_timing(r, *scenario) : WireTiming{}; !timing.empty()) {
        summary["wire_timing"] = Json::parse(wire_timing_json(timing));
    }
    return summary.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<void> write_summary(Results const& r) {
    std::error_code ignored;
    fs::create_directories(r.folder / "report", ignored);
    return replace_file(r.folder / "report" / "summary.json", summary_json(r));
}

std::string to_text(Results const& r, bool colour) {
    std::string out;
    std::size_t width = 12;
    for (ExpectationResult const& e : r.expectations) {
        width = std::max(width, e.name.size());
    }
    if (!r.expectations.empty()) {
        out += "expectations\n";
        for (ExpectationResult const& e : r.expectations) {
            std::string const status = fmt::format("{:<5}", name_of(e.status));
            out += fmt::format("  {:<{}}  {:>16}  {:<18} {}{}{}\n", printable(e.name), width, printable(value_text(e)),
                               printable(e.band.to_string()), paint(status, e.status, colour),
                               e.advisory && e.status == Status::failed ? " (advisory)" : "",
                               e.detail.empty() || e.status == Status::passed ? "" : "  " + printable(e.detail));
        }
    }
    bool const any_bad = std::any_of(r.processes.begin(), r.processes.end(), [](auto const& p) { return p.code != 0; });
    if (any_bad) {
        out += "processes\n";
        for (Results::ProcessRow const& p : r.processes) {
            out +=
                fmt::format("  {:<{}}  {:<20} {}\n", printable(p.name), width, printable(p.program), printable(p.end));
        }
    }
    if (!r.recording_note.empty()) {
        out += fmt::format("recording: {}\n", printable(r.recording_note));
    }
    for (std::string const& note : r.notes) {
        out += fmt::format("note: {}\n", printable(note));
    }
    for (LoggedEvent const& event : r.events) {
        if (is_of_strangers(event)) {
            out += fmt::format("not of this run: {}: {}\n", printable(event.source), printable(event.text));
        }
    }
    if (!r.comtrade.empty()) {
        out += fmt::format("comtrade: {}\n", printable(join(r.comtrade, " ")));
    }
    double const speed = r.outcome.wall_s > 0 ? r.outcome.simulated_s / r.outcome.wall_s : 0;
    out += fmt::format("{} simulated in {}{}{}\n", human_duration(r.outcome.simulated_s),
                       human_duration(r.outcome.wall_s), speed > 0 ? fmt::format(" (x{:.4g})", speed) : "",
                       r.outcome.overruns > 0 ? fmt::format(", {} overruns", r.outcome.overruns) : "");
    return out;
}

std::string to_junit(Results const& r) {
    auto const failures = std::count_if(r.expectations.begin(), r.expectations.end(),
                                        [](auto const& e) { return e.status == Status::failed && !e.advisory; });
    std::string out = fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" "
                                  "failures=\"{}\" errors=\"{}\" time=\"{:.3f}\">\n",
                                  escape_markup(r.scenario), r.expectations.size() + 1, failures,
                                  r.outcome.exit_code != 0 ? 1 : 0, r.outcome.wall_s);
    out += fmt::format("  <testcase classname=\"{}\" name=\"run\">", escape_markup(r.scenario));
    if (r.outcome.exit_code != 0) {
        out += fmt::format("<error message=\"{}\"/>", escape_markup(r.outcome.cause));
    }
    out += "</testcase>\n";
    for (ExpectationResult const& e : r.expectations) {
        out += fmt::format("  <testcase classname=\"{}\" name=\"{}\" time=\"0.000\">", escape_markup(r.scenario),
                           escape_markup(e.name)); // judged from what the run has recorded
        if (e.status == Status::failed && !e.advisory) {
            out += fmt::format("<failure message=\"{}\"/>",
                               escape_markup(fmt::format("value {}, expected {}{}{}", value_text(e), e.band.to_string(),
                                                         e.detail.empty() ? "" : "; ", e.detail)));
        } else if (e.status == Status::not_applicable) {
            out += "<skipped/>";
        }
        out += "</testcase>\n";
    }
    return out + "</testsuite>\n";
}

} // namespace gridspace::launcher
