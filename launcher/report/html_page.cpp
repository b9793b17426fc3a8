// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/html_page.hpp"

#include "common/text.hpp"
#include "launcher/report/report_assets.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {

std::string html_row(std::vector<std::string> const& cells, char const* tag) {
    std::string out = "<tr>";
    for (std::string const& cell : cells) {
        out += fmt::format("<{}>{}</{}>", tag, cell, tag);
    }
    return out + "</tr>\n";
}

std::string html_table(ReportTable const& t) {
    std::vector<std::string> header = t.header;
    std::transform(header.begin(), header.end(), header.begin(), escape_markup);
    std::string out =
        fmt::format("<section tabindex=\"0\"><h2>{}</h2>\n<table>{}", escape_markup(t.title), html_row(header, "th"));
    for (auto const& cells : t.rows) {
        out += html_row(cells, "td");
    }
    return out + "</table>" + (t.note.empty() ? "" : "<p class=\"method\">" + escape_markup(t.note) + "</p>") +
           "</section>\n";
}

std::string html_page(std::string_view title, std::string_view body, std::string_view script) {
    return fmt::format("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                       "content=\"width=device-width\">"
                       "<title>{}</title><style>{}</style></head>\n<body><main>{}</main>\n{}</body></html>\n",
                       escape_markup(title), kReportCss, body,
                       script.empty() ? "" : fmt::format("<script>{}</script>", script));
}

} // namespace gridspace::launcher
