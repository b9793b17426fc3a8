// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/real_time_table.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

std::vector<std::string> lateness_row(std::string const& what, Lateness::Summary const& l) {
    return {escape_markup(what),
            fmt::format("{:.1f}", l.period_us),
            std::to_string(l.instants),
            fmt::format("{:.0f}", l.p50_us),
            fmt::format("{:.0f}", l.p99_us),
            fmt::format("{:.0f}", l.p999_us),
            fmt::format("{:.0f}", l.worst_us),
            std::to_string(l.later_than_a_period)};
}

} // namespace

ReportTable real_time_table(Results const& r) {
    ReportTable t{"How real-time it was",
                  {"", "every, us", "instants", "late by, us: p50", "p99", "p99.9", "worst", "by more than a period"},
                  {},
                  "A tick is late when it is published after its instant, by so much; it is counted among the late "
                  "ticks when it was not even computed by then. "};
    if (!r.outcome.ticks) {
        return t;
    }
    t.rows.push_back(lateness_row("ticks of this run", *r.outcome.ticks));
    if (!r.machine_latency) {
        t.note += "What this machine can do was not measured before the run: gridspace doctor --latency.";
        return t;
    }
    for (MachineLatency::Way const& way : r.machine_latency->ways) {
        t.rows.push_back(lateness_row("this machine: " + way.name, way.lateness));
    }
    t.note += fmt::format("The machine without a run, each row with one thing more than the one above: "
                          "gridspace doctor --latency, {}, {}.",
                          r.machine_latency->measured, r.machine_latency->load);
    return t;
}

} // namespace gridspace::launcher
