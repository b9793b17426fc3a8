// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_page.hpp"

#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/report/report_assets.hpp"
#include "launcher/sweep/study_assets.hpp"
#include "launcher/sweep/study_statistics.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWorstCases = 12, kShownRuns = 2000;

std::string row(std::vector<std::string> const& cells, char const* tag, std::string const& attributes = "") {
    std::string out = fmt::format("<tr{}>", attributes);
    for (std::string const& cell : cells) {
        out += fmt::format("<{0}>{1}</{0}>", tag, cell);
    }
    return out + "</tr>\n";
}

std::string section(std::string const& title, std::string const& body) {
    return fmt::format("<section><h2>{}</h2>\n{}</section>\n", title, body);
}

std::string number(double value) {
    return fmt::format("{:.5g}", value);
}

std::string link_to_run(std::size_t run) {
    return fmt::format("<a href=\"#run-{0}\">{0}</a>", run + 1);
}

std::string badge(std::optional<RunRecord> const& record) {
    return !record             ? "<span class=\"dim\">open</span>"
           : record->exit == 0 ? "<span class=\"ok\">✓ passed</span>"
           : record->exit == 1 ? "<span class=\"bad\">✗ failed</span>"
                               : "<span class=\"bad\">✗ ended early</span>";
}

std::string repeat(StudyFolder const& folder, std::string const& key) {
    return fmt::format("<button class=\"copy\" data-text=\"{0}\" title=\"{0}\">copy command</button>",
                       escape_markup(folder.command(key)));
}

/// Relative to the page: the folder may be moved as a whole.
std::string report_link(std::optional<RunRecord> const& record, std::string const& key) {
    return record && record->is_kept ? fmt::format("<a href=\"runs/{}/run/report/index.html\">report</a>", key) : "";
}

std::string source_of(Parameter const& p) {
    if (!p.distribution) {
        std::string const first = cell_text(p.values.front()), last = cell_text(p.values.back());
        return p.values.size() == 1 ? first : fmt::format("{} values, {} … {}", p.values.size(), first, last);
    }
    Distribution const& d = *p.distribution;
    switch (d.kind) {
    case Distribution::Kind::uniform:
        return fmt::format("uniform, {} to {}", shortest(d.low), shortest(d.high));
    case Distribution::Kind::log_uniform:
        return fmt::format("log-uniform, {} to {}", shortest(d.low), shortest(d.high));
    case Distribution::Kind::triangular:
        return fmt::format("triangular, {} to {}, most likely {}", shortest(d.low), shortest(d.high), shortest(d.mode));
    case Distribution::Kind::normal:
        break;
    }
    std::string out = fmt::format("normal, {} ± {}", shortest(d.mean), shortest(d.deviation));
    out += std::isfinite(d.low) ? fmt::format(", at least {}", shortest(d.low)) : "";
    return out + (std::isfinite(d.high) ? fmt::format(", at most {}", shortest(d.high)) : "");
}

std::string facts(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records) {
    double wall_s = 0;
    std::size_t done = 0;
    for (auto const& record : records) {
        wall_s += record ? record->wall_s : 0;
        done += record ? 1 : 0;
    }
    std::string out = "<dl class=\"facts\">";
    for (auto const& [name, value] :
         {std::pair{"scenario", plan.scenario},
          {"runs", std::to_string(plan.runs.size())},
          {"repetitions of each point", study.repetitions > 1 ? std::to_string(study.repetitions) : ""},
          {"left out by conditions", plan.left_out > 0 ? std::to_string(plan.left_out) + " points" : ""},
          {"a run took", done > 0 ? human_duration(wall_s / static_cast<double>(done)) : ""}}) {
        out += value.empty() ? "" : fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", name, escape_markup(value));
    }
    return out + "</dl>\n";
}

std::string worst(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records,
                  std::vector<ResultStatistics> const& statistics, StudyFolder const& folder) {
    auto const cases = worst_cases(statistics, records, kWorstCases);
    if (cases.empty()) {
        return "";
    }
    std::string out = "<table>" + row({"run", "", "what happened", "with", "", ""}, "th");
    for (WorstCase const& c : cases) {
        StudyRun const& run = plan.runs[c.run];
        out += row({link_to_run(c.run), badge(records[c.run]), escape_markup(c.why),
                    escape_markup(describe(study, run)), report_link(records[c.run], run.key), repeat(folder, run.key)},
                   "td");
    }
    return section("Worst cases", out + "</table><p class=\"method\">First what ended early, then what failed by the "
                                        "most, then what passed by the least.</p>");
}

std::string parameters(Study const& study) {
    if (study.parameters.empty()) {
        return "";
    }
    std::string out = "<table>" + row({"parameter", "of the scenario", "values"}, "th");
    for (Parameter const& p : study.parameters) {
        std::vector<std::string> paths;
        for (Ref const& path : p.paths) {
            paths.push_back(escape_markup(path.name));
        }
        out += row({escape_markup(p.name.name), join(paths, "<br>"), escape_markup(source_of(p))}, "td");
    }
    std::string how = study.parameters.size() < 2 ? ""
                      : study.combine == Study::Combine::zip
                          ? "Zipped: the first values together, then the second, and so on."
                          : "Crossed: every value with every other.";
    if (std::any_of(study.parameters.begin(), study.parameters.end(),
                    [](Parameter const& p) { return p.distribution.has_value(); })) {
        how += fmt::format(" Draws: {}, seed {}.", study.sampling.latin_hypercube ? "Latin hypercube" : "random",
                           study.sampling.seed);
    }
    for (Ref const& condition : study.where) {
        how += " Only where " + condition.name + ".";
    }
    return section("What varies",
                   out + "</table>" + (how.empty() ? "" : "<p class=\"method\">" + escape_markup(how) + "</p>"));
}

std::string accepted(ResultStatistics const& s) {
    return s.low && s.high ? fmt::format("{} … {}", number(*s.low), number(*s.high))
           : s.low         ? "≥ " + number(*s.low)
           : s.high        ? "≤ " + number(*s.high)
                           : "";
}

std::string statistics_table(std::vector<ResultStatistics> const& all) {
    std::string out =
        "<table>" +
        row({"result", "runs", "lowest", "5 %", "median", "mean", "95 %", "highest", "accepted", "failed"}, "th");
    for (ResultStatistics const& s : all) {
        std::string const name =
            escape_markup(s.name) +
            (s.unit.empty() ? "" : fmt::format(" <span class=\"dim\">{}</span>", escape_markup(s.unit)));
        std::string const failed = s.failed > 0 ? fmt::format("<span class=\"bad\">{}</span>", s.failed) : "0";
        std::string const count = std::to_string(s.count);
        if (s.count == 0) {
            out += row({name, "0", "–", "–", "–", "–", "–", "–", accepted(s), failed}, "td");
        } else if (s.is_condition()) {
            out += row({name, count, fmt::format("holds in {:.0f}", s.mean * static_cast<double>(s.count)), "", "", "",
                        "", "", "", failed},
                       "td");
        } else {
            auto const extreme = [](double value, std::size_t run) {
                return fmt::format("{} <span class=\"dim\">(run {})</span>", number(value), link_to_run(run));
            };
            out += row({name, count, extreme(s.min, s.lowest), number(s.p05), number(s.median), number(s.mean),
                        number(s.p95), extreme(s.max, s.highest), accepted(s), failed},
                       "td");
        }
    }
    return section("Results", out + "</table>");
}

std::string run_table(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records,
                      std::vector<ResultStatistics> const& statistics, StudyFolder const& folder) {
    std::vector<std::string> header{"run", "state"};
    for (Parameter const& p : study.parameters) {
        header.push_back(escape_markup(p.name.name));
    }
    if (study.repetitions > 1) {
        header.emplace_back("repetition");
    }
    for (ResultStatistics const& s : statistics) {
        header.push_back(escape_markup(s.name) +
                         (s.unit.empty() ? "" : fmt::format(" <span class=\"dim\">{}</span>", escape_markup(s.unit))));
    }
    header.insert(header.end(), {"", ""});
    std::string out = "<table class=\"runs\"><thead>" + row(header, "th") + "</thead><tbody>\n";
    for (std::size_t i = 0; i < std::min(plan.runs.size(), kShownRuns); ++i) {
        StudyRun const& run = plan.runs[i];
        std::vector<std::string> cells{std::to_string(i + 1), badge(records[i])};
        for (config::Node const& value : run.point) {
            auto const n = config::number_of(value);
            cells.push_back(n ? fmt::format("{:.6g}", *n) : escape_markup(cell_text(value)));
        }
        if (study.repetitions > 1) {
            cells.push_back(std::to_string(run.repetition));
        }
        for (ResultStatistics const& s : statistics) {
            RunRecord::Value const* const v = records[i] ? records[i]->find(s.name) : nullptr;
            std::string const text = v == nullptr || !v->value ? "–"
                                     : s.is_condition()        ? (*v->value != 0 ? "holds" : "does not hold")
                                                               : number(*v->value);
            cells.push_back(v != nullptr && v->passed == false ? fmt::format("<span class=\"bad\">{}</span>", text)
                                                               : text);
        }
        cells.insert(cells.end(), {report_link(records[i], run.key), repeat(folder, run.key)});
        out += row(cells, "td", fmt::format(" id=\"run-{}\"", i + 1));
    }
    out += "</tbody></table>";
    if (plan.runs.size() > kShownRuns) {
        out += fmt::format(
            "<p class=\"method\">The first {} of {} runs; results.csv and results.sqlite have all of them.</p>",
            kShownRuns, plan.runs.size());
    }
    return section(
        "Runs <span class=\"files\"><a href=\"results.csv\">CSV</a> <a href=\"results.sqlite\">SQLite</a></span>", out);
}

/// What the drawings need, as JSON that may stand in a script element: no '<' in it, and nothing beyond ASCII.
std::string data_of(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records,
                    std::vector<ResultStatistics> const& statistics) {
    Json columns = Json::array(), states = Json::array(), labels = Json::array();
    auto const column = [&](std::string const& name, std::string const& unit, bool result, Json values) {
        bool const numbers =
            std::all_of(values.begin(), values.end(), [](Json const& v) { return v.is_null() || v.is_number(); });
        columns.push_back(
            {{"name", name}, {"unit", unit}, {"result", result}, {"numbers", numbers}, {"values", std::move(values)}});
    };
    for (std::size_t c = 0; c < study.parameters.size(); ++c) {
        Json values = Json::array();
        for (StudyRun const& run : plan.runs) {
            auto const n = config::number_of(run.point[c]);
            values.push_back(n ? Json(*n) : Json(cell_text(run.point[c])));
        }
        column(study.parameters[c].name.name, "", false, std::move(values));
    }
    for (ResultStatistics const& s : statistics) {
        Json values = Json::array();
        for (auto const& record : records) {
            RunRecord::Value const* const v = record ? record->find(s.name) : nullptr;
            values.push_back(v != nullptr && v->value && std::isfinite(*v->value) ? Json(*v->value) : Json(nullptr));
        }
        column(s.name, s.unit, true, std::move(values));
        columns.back()["condition"] = s.is_condition();
        columns.back()["low"] = s.low ? Json(*s.low) : Json(nullptr);
        columns.back()["high"] = s.high ? Json(*s.high) : Json(nullptr);
    }
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        states.push_back(records[i] ? records[i]->state() : "open");
        labels.push_back(describe(study, plan.runs[i]));
    }
    std::string out = Json{{"columns", columns}, {"states", states}, {"labels", labels}}.dump(
        -1, ' ', true, Json::error_handler_t::replace);
    for (std::size_t at = 0; (at = out.find('<', at)) != std::string::npos;) {
        out.replace(at, 1, "\\u003c");
    }
    return out;
}

std::string verdict(StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records) {
    auto const count = [&](std::string_view state) {
        return std::count_if(records.begin(), records.end(),
                             [&](auto const& r) { return state == (r ? r->state() : "open"); });
    };
    std::string text = fmt::format("{} of {} runs passed", count("passed"), plan.runs.size());
    for (auto const& [state, what] :
         {std::pair{"failed", "failed"}, {"ended_early", "ended early"}, {"open", "are not done yet"}}) {
        text += count(state) > 0 ? fmt::format(", {} {}", count(state), what) : "";
    }
    bool const ok = count("passed") == static_cast<std::ptrdiff_t>(plan.runs.size());
    return fmt::format("<p class=\"verdict {}\">{} {}</p>", ok ? "ok" : "bad", ok ? "✓" : "✗", text);
}

} // namespace

std::string study_page(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records,
                       StudyFolder const& folder) {
    auto const statistics = statistics_of(plan.results, records);
    std::string body = fmt::format("<header><h1>{}</h1><p>{}</p>{}</header>\n", escape_markup(study.name),
                                   escape_markup(study.description), verdict(plan, records));
    body += facts(study, plan, records);
    if (!plan.lockstep) {
        body += "<p class=\"warn\">▲ The scenario runs in real time: what runs at the same time disturbs each other, "
                "and nothing repeats exactly.</p>\n";
    }
    body += worst(study, plan, records, statistics, folder) + statistics_table(statistics);
    body += section("Any two columns", "<div id=\"scatter\"></div>") +
            section("Distributions", "<div id=\"histograms\"></div>");
    body += parameters(study) + run_table(study, plan, records, statistics, folder);
    return fmt::format("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                       "content=\"width=device-width\">"
                       "<title>{} – Gridspace study</title><style>{}\n{}</style></head>\n<body><main>{}</main>\n"
                       "<script>const study={};\n{}</script></body></html>\n",
                       escape_markup(study.name), kReportCss, kStudyCss, body,
                       data_of(study, plan, records, statistics), kStudyJs);
}

} // namespace gridspace::launcher
