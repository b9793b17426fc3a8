// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/breakdown.hpp"

#include <algorithm>

namespace gridspace::launcher {
namespace {

Share& row_of(std::vector<Share>& rows, std::string const& parameter, std::string const& value) {
    auto const it = std::find_if(rows.begin(), rows.end(),
                                 [&](Share const& s) { return s.parameter == parameter && s.value == value; });
    return it != rows.end() ? *it : rows.emplace_back(Share{parameter, value, {}, {}});
}

void count(Share& row, Outcome outcome, RunRecord const& record) {
    ++row.right.of;
    if (outcome == Outcome::right) {
        ++row.right.successes;
        if (auto const ms = trip_time(record)) {
            row.trip_ms.push_back(*ms);
        }
    }
}

} // namespace

std::vector<Share> breakdown(CertifyCase const& all, std::vector<GroupResult> const& groups) {
    std::vector<Share> rows;
    for (GroupResult const& group : groups) {
        for (std::size_t i = 0; i < group.finished.records.size(); ++i) {
            auto const& record = group.finished.records[i];
            Outcome const outcome = record ? outcome_of(group.group, *record) : Outcome::ended_early;
            for (std::size_t p = 0; p < group.plan.runs[i].point.size() && outcome != Outcome::ended_early; ++p) {
                Parameter const& parameter = group.study.parameters[p];
                if (!parameter.values.empty()) {
                    count(row_of(rows, parameter.name.name, cell_text(group.plan.runs[i].point[p])), outcome, *record);
                }
            }
        }
    }
    for (Share& row : rows) {
        row.right = clopper_pearson(row.right.successes, row.right.of, all.confidence);
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](Share const& a, Share const& b) { return a.parameter < b.parameter; });
    return rows;
}

} // namespace gridspace::launcher
