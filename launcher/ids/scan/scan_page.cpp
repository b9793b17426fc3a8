// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/ids/scan/scan_output.hpp"
#include "launcher/ids/scan/scan_rows.hpp"
#include "launcher/report/html_page.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::scan {
namespace {

/// A page is no wider than what was found: columns that say nothing in any row are left out.
Rows without_empty_columns(Rows const& rows) {
    Rows out(rows.size());
    for (std::size_t column = 0; column < rows.front().size(); ++column) {
        auto const says_something = [&](auto const& row) { return !row[column].empty() && row[column] != "-"; };
        bool const stays = std::any_of(rows.begin() + 1, rows.end(), says_something);
        for (std::size_t row = 0; stays && row < rows.size(); ++row) {
            out[row].push_back(rows[row][column]);
        }
    }
    return out;
}

/// Names in a capture are whatever somebody wrote.
std::string section(std::string title, Rows const& all, std::string note) {
    if (all.size() < 2) {
        return "";
    }
    Rows const rows = without_empty_columns(all);
    launcher::ReportTable table{std::move(title), rows.front(), {rows.begin() + 1, rows.end()}, std::move(note)};
    for (auto& row : table.rows) {
        std::transform(row.begin(), row.end(), row.begin(), escape_markup);
    }
    return launcher::html_table(table);
}

} // namespace

std::string to_page(CaptureScan const& scan, std::filesystem::path const& file) {
    std::string const name = printable(file.filename().string());
    bool const alarms = scan.has_alarms();
    std::string body = fmt::format(
        "<header class=\"wide\"><h1>{}</h1><p>{} frames in {:.6f} s</p><p class=\"verdict {}\">{}</p></header>\n",
        escape_markup(name), scan.frames, static_cast<double>(scan.last_ns - scan.first_ns) * 1e-9,
        alarms ? "bad" : "ok", alarms ? "✗ alarms were raised" : "✓ no alarm");
    for (std::string const& note : notes_of(scan)) {
        body += fmt::format("<p class=\"warn\">▲ {}</p>\n", escape_markup(note));
    }
    body += section("Alarms", alarm_rows(scan),
                    "The frame is Wireshark's frame.number; the time is that since the first frame of the capture.");
    body +=
        section("Streams", stream_rows(scan),
                "Counted over all senders of the name. Copies: samples or messages that came again. Jumps: of smpCnt, "
                "or restarts of a GOOSE publisher. confRev: changes. Foreign: frames of other addresses than the first "
                "one. Off forecast: samples that those before them do not explain. Columns without any are left out.");
    body +=
        section("Lines", line_rows(scan),
                "Both ends of a line as a relay with our detector sees them: phasors over one cycle, pickup at 30 % of "
                "the nominal current, slope 30 %.");
    return launcher::html_page(name + " – Gridspace scan", body);
}

} // namespace gridspace::scan
