// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/html_report.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/judge/expectation_rule.hpp"
#include "launcher/report/authentication_table.hpp"
#include "launcher/report/detector_tables.hpp"
#include "launcher/report/event_tables.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/html_page.hpp"
#include "launcher/report/one_line_figure.hpp"
#include "launcher/report/real_time_table.hpp"
#include "launcher/report/relay_settings_table.hpp"
#include "launcher/report/report_assets.hpp"
#include "launcher/report/tables.hpp"
#include "launcher/report/wire_timing_page.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using Status = ExpectationResult::Status;

std::string expectations(Results const& r, config::Node const& scenario) {
    if (r.expectations.empty()) {
        return "";
    }
    std::map<std::string, std::string> rules;
    if (config::Node const* expect = scenario.find("expect"); expect != nullptr) {
        config::Diagnostics unread; // it was judged, so it can be read
        for (Expectation const& e : read_expectations(*expect, unread)) {
            rules[e.name.name] = rule_of(e);
        }
    }
    std::string out = "<section tabindex=\"0\"><h2>Expectations</h2>\n<table class=\"expect\">" +
                      html_row({"", "name", "value", "accepted", "what happened"}, "th");
    for (ExpectationResult const& e : r.expectations) {
        bool const condition = e.verb == "always" || e.verb == "never" || e.verb == "eventually";
        std::string const value = !e.value    ? "–"
                                  : condition ? (*e.value != 0 ? "holds" : "does not hold")
                                              : fmt::format("{:.6g} {}", *e.value, escape_markup(e.unit));
        char const* badge = e.status == Status::passed   ? "<span class=\"ok\">✓ pass</span>"
                            : e.status == Status::failed ? (e.advisory ? "<span class=\"warn\">▲ advisory</span>"
                                                                       : "<span class=\"bad\">✗ fail</span>")
                                                         : "<span class=\"dim\">shown</span>";
        out += html_row(
            {badge, fmt::format("{}<div class=\"rule\">{}</div>", escape_markup(e.name), escape_markup(rules[e.name])),
             value, escape_markup(e.band.to_string()), escape_markup(e.detail)},
            "td");
    }
    return out + "</table></section>\n";
}

/// The names of the expectations that do not hold.
std::vector<std::string> failed(Results const& r, bool advisory) {
    std::vector<std::string> out;
    for (ExpectationResult const& e : r.expectations) {
        if (e.status == Status::failed && e.advisory == advisory) {
            out.push_back(e.name);
        }
    }
    return out;
}

/// The first line of the report: what decides the exit code, and what is only advice.
std::string verdict(Results const& r) {
    auto const binding = failed(r, false), advice = failed(r, true);
    if (r.outcome.exit_code != 0) {
        return "✗ " + r.outcome.cause;
    }
    if (r.unjudged) {
        return "✗ " + r.notes.back();
    }
    if (!binding.empty()) {
        return fmt::format("✗ {} of {} expectations failed: {}", binding.size(), r.expectations.size(),
                           join(binding, ", "));
    }
    auto const shown = std::ranges::count(r.expectations, Status::shown, &ExpectationResult::status);
    std::string const beside = shown == 0 ? "" : fmt::format(" ({} more are shown, not judged)", shown);
    return r.expectations.empty() ? "✓ it ran to its end; the scenario expects nothing"
           : advice.empty()       ? "✓ every expectation holds" + beside
                                  : "✓ passed; advisory expectations that do not hold: " + join(advice, ", ");
}

std::string facts(Results const& r) {
    double const speed = r.outcome.wall_s > 0 ? r.outcome.simulated_s / r.outcome.wall_s : 0;
    std::vector<std::pair<std::string, std::string>> const items{
        {"clock", r.mode},
        {"simulated", human_duration(r.outcome.simulated_s)},
        {"wall time", fmt::format("{} (×{:.4g})", human_duration(r.outcome.wall_s), speed)},
        {"late ticks (overruns)", r.mode == "lockstep" ? "" : std::to_string(r.outcome.overruns)},
        {"scheduling", r.scheduling.substr(0, r.scheduling.find(':'))},
        {"idle processors", r.idle_processors.substr(0, r.idle_processors.find(':'))},
        {"epoch", format_utc(r.epoch_unix_s)},
    };
    std::string out = "<dl class=\"facts\">";
    for (auto const& [name, value] : items) {
        if (value.empty()) {
            continue;
        }
        out += fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", name, escape_markup(value));
    }
    return out + "</dl>\n";
}

std::string notes(config::Node const& scenario) {
    config::Node const* list = scenario.find("notes");
    if (list == nullptr || !list->is_sequence() || list->items.empty()) {
        return "";
    }
    std::string out = "<section class=\"box\"><h2>Assumptions taken</h2><ul>\n";
    for (config::Node const& note : list->items) {
        out += fmt::format("<li>{}</li>\n", escape_markup(note.text));
    }
    return out + "</ul></section>\n";
}

ReportTable process_table(Results const& r) {
    ReportTable t{"Processes", {"process", "program", "host", "end", "processor time"}, {}};
    for (Results::ProcessRow const& p : r.processes) {
        t.rows.push_back({escape_markup(p.name), escape_markup(p.program), escape_markup(p.host), escape_markup(p.end),
                          p.cpu_s > 0 ? fmt::format("{:.2f} s", p.cpu_s) : "-"});
    }
    return t;
}

ReportTable topic_table(Results const& r) {
    ReportTable t{"Topics", {"topic", "type", "samples", "written by"}, {}};
    for (Results::Topic const& topic : r.topics) {
        t.rows.push_back({escape_markup(topic.topic), escape_markup(topic.type), std::to_string(topic.samples),
                          escape_markup(join(topic.processes, ", "))});
    }
    return t;
}

/// Disturbance records, with links.
std::string files_table(Results const& r) {
    std::string out;
    for (std::string const& file : r.comtrade) {
        out +=
            fmt::format("<li><a href=\"../comtrade/{0}\">{0}</a> and <a href=\"../comtrade/{1}.dat\">.dat</a></li>\n",
                        escape_markup(file), escape_markup(file.substr(0, file.rfind('.'))));
    }
    return out.empty() ? out
                       : "<section class=\"box\"><h2>Disturbance records (IEEE C37.111-2013)</h2><ul>\n" + out +
                             "</ul></section>\n";
}

/// Frames on the links, datagrams and samples that were none of the run, as those say who kept them out.
ReportTable stranger_table(Results const& r) {
    ReportTable t{"Not of this run, and without effect", {"link or bus", "kept out by", "how many, and from whom"}, {}};
    for (LoggedEvent const& e : r.events) {
        if (is_of_strangers(e)) {
            std::size_t const link = e.text.find(" on '"), end = e.text.find('\'', link + 5);
            bool const named = link != std::string::npos && end != std::string::npos;
            t.rows.push_back({named ? escape_markup(e.text.substr(link + 5, end - link - 5)) : "bus",
                              escape_markup(e.source), escape_markup(e.text)});
        }
    }
    std::ranges::stable_sort(t.rows, {}, [](auto const& cells) { return cells.front(); });
    return t;
}

constexpr std::size_t kFewEvents = 12, kStoryFigures = 4; // the first figures come before the tables

/// The drawings, one after the other; also as files. `data`: what the page's script needs of them.
Result<std::vector<std::string>> drawings(Results const& r, std::vector<Figure> figures, std::string& data) {
    std::vector<std::string> out;
    for (Figure& figure : figures) {
        figure.id = as_file_name(figure.id);
        std::string const svg = to_svg(figure);
        for (auto const& [ending, text] :
             {std::pair{".svg", "<?xml version=\"1.0\"?>\n" + svg}, {".csv", to_csv(figure)}}) {
            if (auto ok = replace_file(r.folder / "report" / "figures" / (figure.id + ending), text); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        out.push_back(
            fmt::format("<figure id=\"{0}\" tabindex=\"0\"><figcaption>{1} <span class=\"files\"><a "
                        "href=\"figures/{0}.svg\">SVG</a> "
                        "<a href=\"figures/{0}.csv\">CSV</a></span></figcaption>{2}{3}</figure>\n",
                        figure.id, escape_markup(figure.title), svg,
                        figure.note.empty() ? "" : "<p class=\"method\">" + escape_markup(figure.note) + "</p>"));
        if (figure.interactive()) {
            data += (data.empty() ? "" : ",") + to_json(figure);
        }
    }
    return out;
}

/// What the run was, how it ended, and what to be wary of.
std::string opening(Results const& r) {
    bool const passed = r.exit_code() == 0;
    std::string body =
        fmt::format("<header><h1>{}</h1><p>{}</p><p class=\"verdict {}\">{}</p></header>\n", escape_markup(r.scenario),
                    escape_markup(r.description), passed ? "ok" : "bad", escape_markup(verdict(r)));
    body += facts(r);
    if (!r.recording_note.empty()) {
        body += fmt::format("<p class=\"warn\">▲ recording: {}</p>\n", escape_markup(r.recording_note));
    }
    for (std::string const& note : r.notes) {
        body += fmt::format("<p class=\"warn\">▲ {}</p>\n", escape_markup(note));
    }
    return body;
}

} // namespace

Result<fs::path> write_html_report(Results const& r) {
    config::Diagnostics ignored;
    auto const loaded = config::load_yaml(r.folder / "scenario.resolved.yaml", ignored);
    config::Node const scenario = loaded ? *loaded : config::Node::map();
    std::error_code error;
    fs::create_directories(r.folder / "report" / "figures", error);
    std::string body = opening(r);
    ReportSettings const settings = report_settings(scenario);
    WireTiming const timing = measure_wire_timing(r, scenario);
    std::string data;
    auto const figures = drawings(r, make_figures(settings, {r, scenario, timing}), data);
    if (!figures) {
        return std::unexpected{figures.error()};
    }
    auto const add_tables = [&](std::vector<ReportTable> const& tables) {
        std::ranges::for_each(tables, [&](ReportTable const& t) { body += t.rows.empty() ? "" : html_table(t); });
    };
    ReportTable events = event_table(r, scenario);
    bool const few_events = events.rows.size() <= kFewEvents;
    if (few_events) {
        add_tables({events});
    } else if (ReportTable const main = main_events(r, scenario); main.rows.size() <= 2 * kFewEvents) {
        add_tables({main});
    }
    auto const diagram = one_line_figure(r);
    if (!diagram) {
        return std::unexpected{diagram.error()};
    }
    body += *diagram;
    add_tables(chain_tables(timing, published_of(scenario)));
    auto const rest = figures->begin() + static_cast<std::ptrdiff_t>(std::min(kStoryFigures, figures->size()));
    std::for_each(figures->begin(), rest, [&](std::string const& drawing) { body += drawing; });
    body += expectations(r, scenario);
    add_tables({relay_settings_table(scenario)});
    add_tables(make_tables(settings, r));
    add_tables(r.consequences ? consequence_tables(*r.consequences) : std::vector<ReportTable>{});
    add_tables(detector_tables(r.intrusion));
    add_tables(wire_timing_tables(timing, published_of(scenario)));
    add_tables({real_time_table(r), authentication_table(r, scenario)});
    std::for_each(rest, figures->end(), [&](std::string const& drawing) { body += drawing; });
    body += notes(scenario) + files_table(r);
    add_tables({stranger_table(r)});
    if (!few_events) {
        events.title = "All that happened";
        add_tables({events});
    }
    body += html_table(process_table(r)) + html_table(topic_table(r));
    std::string const page =
        html_page(r.scenario + " – Gridspace report", body, fmt::format("const figures=[{}];\n{}", data, kReportJs));
    fs::path file = r.folder / "report" / "index.html";
    if (auto ok = replace_file(file, page); !ok) {
        return std::unexpected{ok.error()};
    }
    return file;
}

} // namespace gridspace::launcher
