// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/certify/breakdown.hpp"
#include "launcher/report/report_assets.hpp"
#include "launcher/sweep/study_assets.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <numeric>

namespace gridspace::launcher {
namespace {

constexpr std::size_t kBars = 24;

std::string percent(double share) {
    return fmt::format("{:.2f} %", 100 * share);
}

std::string row(std::string const& name, Proportion const& p) {
    return p.of == 0 ? fmt::format("<tr><td>{}</td><td>no such fault</td><td></td><td></td></tr>\n", name)
                     : fmt::format("<tr><td>{}</td><td>{} of {}</td><td>{}</td><td>{} … {}</td></tr>\n", name,
                                   p.successes, p.of, percent(p.estimate), percent(p.low), percent(p.high));
}

/// How many trips came when; bars of equal width from the fastest to the slowest.
std::string histogram(std::vector<double> const& ms) {
    if (ms.empty()) {
        return "<p>The relay has not tripped in time for any fault.</p>\n";
    }
    double const low = ms.front(), width = std::max(ms.back() - low, 1e-3) / kBars;
    std::array<std::size_t, kBars> counts{};
    for (double const t : ms) {
        ++counts[std::min(static_cast<std::size_t>((t - low) / width), kBars - 1)];
    }
    auto const most = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
    std::string out = "<svg viewBox=\"0 0 620 190\" width=\"620\" role=\"img\" aria-label=\"trip times\">\n";
    for (std::size_t i = 0; i < kBars; ++i) {
        double const height = 150 * static_cast<double>(counts[i]) / most;
        out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"22\" height=\"{:.1f}\" fill=\"#3a78b5\">"
                           "<title>{:.2f} to {:.2f} ms: {}</title></rect>\n",
                           10 + 25 * static_cast<double>(i), 160 - height, height, low + width * static_cast<double>(i),
                           low + width * static_cast<double>(i + 1), counts[i]);
    }
    return out + fmt::format("<text x=\"10\" y=\"180\" font-size=\"13\">{:.2f} ms</text>"
                             "<text x=\"608\" y=\"180\" font-size=\"13\" text-anchor=\"end\">{:.2f} ms</text></svg>\n",
                             low, ms.back());
}

std::string found(Judged const& j) {
    return j.value ? fmt::format("{:.6g}", *j.value) : "nothing to count";
}

std::string criteria(Certificate const& c) {
    if (c.criteria.empty()) {
        return "<p>The case asks for nothing: what came out is shown and not judged.</p>\n";
    }
    std::string out = "<table><tr><th>criterion</th><th>limit</th><th>found</th><th></th></tr>\n";
    for (Judged const& j : c.criteria) {
        out += fmt::format("<tr><td>{}</td><td>{:.6g}</td><td>{}</td><td>{}</td></tr>\n", j.name, j.limit, found(j),
                           j.met ? "<span class=\"ok\">✓ met</span>" : "<span class=\"bad\">✗ not met</span>");
    }
    return out + "</table>\n";
}

/// To what is kept of a run.
std::string links(GroupResult const& group, std::size_t run) {
    auto const& record = group.finished.records[run];
    if (!record || !record->is_kept) {
        return "";
    }
    std::string const folder = fmt::format("{}/runs/{}/run", group.group.name.name, group.plan.runs[run].key);
    return fmt::format("<a href=\"{0}/report/index.html\">report</a>, <a href=\"{0}/comtrade\">COMTRADE</a><br>",
                       escape_markup(folder));
}

/// How it went by fault type, by line: by every list of the case.
std::string by_value(CertifyCase const& all, std::vector<GroupResult> const& groups) {
    std::string out = fmt::format("<table><tr><th></th><th></th><th>right</th><th>{:g} % interval</th><th>trips</th>"
                                  "<th>mean ms</th><th>slowest ms</th></tr>\n",
                                  100 * all.confidence);
    std::vector<Share> const shares = breakdown(all, groups);
    for (Share const& s : shares) {
        double const sum = std::accumulate(s.trip_ms.begin(), s.trip_ms.end(), 0.0);
        std::string const times =
            s.trip_ms.empty() ? "<td></td><td></td>"
                              : fmt::format("<td>{:.2f}</td><td>{:.2f}</td>",
                                            sum / static_cast<double>(s.trip_ms.size()), std::ranges::max(s.trip_ms));
        out += fmt::format("<tr><td>{}</td><td>{}</td><td>{} of {}</td><td>{} … {}</td><td>{}</td>{}</tr>\n",
                           escape_markup(s.parameter), escape_markup(s.value), s.right.successes, s.right.of,
                           percent(s.right.low), percent(s.right.high), s.trip_ms.size(), times);
    }
    return shares.empty() ? "<p>Nothing varies by a list.</p>\n" : out + "</table>\n";
}

std::string worst(std::vector<GroupResult> const& groups, Certificate const& c) {
    std::string out = "<table><tr><th>group</th><th>run</th><th>what happened</th><th>fault</th><th>again</th></tr>\n";
    for (WorstFault const& f : c.worst) {
        GroupResult const& group = groups[f.group];
        out += fmt::format("<tr><td><a href=\"{0}/index.html\">{0}</a></td><td>{1}</td><td>{2}</td><td>{3}</td>"
                           "<td>{5}<code>{4}</code></td></tr>\n",
                           escape_markup(group.group.name.name), f.run + 1, escape_markup(f.why),
                           escape_markup(describe(group.study, group.plan.runs[f.run])), escape_markup(f.command),
                           links(group, f.run));
    }
    return out + "</table>\n";
}

} // namespace

std::string certificate_page(CertifyCase const& all, std::vector<GroupResult> const& groups, Certificate const& c) {
    std::string out = fmt::format("<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>"
                                  "<style>{1}{2}</style></head><body><main><h1>{0}</h1><p>{3}</p>\n",
                                  escape_markup(all.name), kReportCss, kStudyCss, escape_markup(all.description));
    out += c.is_passed() ? "<p class=\"ok\">✓ Every criterion is met.</p>\n"
                         : "<p class=\"bad\">✗ Not every criterion is met, or not every run was done.</p>\n";
    if (c.inconclusive + c.open > 0) {
        out += fmt::format("<p class=\"bad\">{} runs ended early and {} were not done; they count for nothing.</p>\n",
                           c.inconclusive, c.open);
    }
    out += "<section><h2>Criteria</h2>\n" + criteria(c) + "</section>\n";
    out += fmt::format("<section><h2>Dependability and security</h2><table><tr><th></th><th>right</th><th>share</th>"
                       "<th>{:g} % interval (Clopper-Pearson)</th></tr>\n",
                       100 * all.confidence);
    out += row("dependability: tripped in time", c.dependability) + row("security: stayed", c.security) +
           "</table></section>\n";
    out += "<section><h2>Trip times</h2>\n" + histogram(c.trip_ms);
    out += fmt::format("<p>{} trips: mean {:.2f} ± {:.2f} ms, median {:.2f} ms, 95 % within {:.2f} ms, slowest {:.2f} "
                       "ms. From the fault to the relay's trip, in simulated time.</p></section>\n",
                       c.trip_ms.size(), c.mean_ms, c.deviation_ms, c.median_ms, c.p95_ms,
                       c.trip_ms.empty() ? 0 : c.trip_ms.back());
    out += "<section><h2>By what varies</h2>\n" + by_value(all, groups) + "</section>\n";
    out += "<section><h2>Worst ten</h2>\n" + worst(groups, c) + "</section>\n<section><h2>Groups</h2><ul>\n";
    for (GroupResult const& group : groups) {
        out += fmt::format("<li><a href=\"{0}/index.html\">{0}</a>: must {1}, {2} runs, {3} as asked</li>\n",
                           escape_markup(group.group.name.name), group.group.must_trip ? "trip" : "stay",
                           group.plan.runs.size(), group.finished.count("passed"));
    }
    return out + "</ul></section></main></body></html>\n";
}

} // namespace gridspace::launcher
