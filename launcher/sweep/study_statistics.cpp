// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

/// Between the two nearest of sorted values, in proportion.
double quantile_of(std::vector<std::pair<double, std::size_t>> const& sorted, double share) {
    double const place = share * static_cast<double>(sorted.size() - 1);
    auto const below = static_cast<std::size_t>(place);
    std::size_t const above = std::min(below + 1, sorted.size() - 1);
    return sorted[below].first + (place - static_cast<double>(below)) * (sorted[above].first - sorted[below].first);
}

/// How far beyond a limit (positive), or how far from the nearest one (negative), in ranges of the result.
std::optional<double> excess(ResultStatistics const& s, RunRecord::Value const& v) {
    if (!v.value || (!v.low && !v.high)) {
        return std::nullopt;
    }
    double const range = s.max > s.min ? s.max - s.min : 1;
    double out = -INFINITY;
    out = v.low ? std::max(out, (*v.low - *v.value) / range) : out;
    return v.high ? std::max(out, (*v.value - *v.high) / range) : out;
}

} // namespace

std::vector<ResultStatistics> statistics_of(std::vector<std::string> const& names,
                                            std::vector<std::optional<RunRecord>> const& records) {
    std::vector<ResultStatistics> out;
    for (std::string const& name : names) {
        ResultStatistics s;
        s.name = name;
        std::vector<std::pair<double, std::size_t>> values;
        double sum = 0;
        for (std::size_t i = 0; i < records.size(); ++i) {
            RunRecord::Value const* const v = records[i] ? records[i]->find(name) : nullptr;
            if (v == nullptr) {
                continue;
            }
            if (s.verb.empty()) {
                s.verb = v->verb;
                s.low = v->low;
                s.high = v->high;
            }
            s.unit = s.unit.empty() ? v->unit : s.unit;
            s.failed += v->passed == false ? 1 : 0;
            if (v->value && std::isfinite(*v->value)) {
                values.emplace_back(*v->value, i);
                sum += *v->value;
            }
        }
        std::sort(values.begin(), values.end());
        s.count = values.size();
        if (!values.empty()) {
            s.min = values.front().first;
            s.max = values.back().first;
            s.lowest = values.front().second;
            s.highest = values.back().second;
            s.mean = sum / static_cast<double>(values.size());
            s.p05 = quantile_of(values, 0.05);
            s.median = quantile_of(values, 0.5);
            s.p95 = quantile_of(values, 0.95);
        }
        out.push_back(std::move(s));
    }
    return out;
}

std::vector<WorstCase> worst_cases(std::vector<ResultStatistics> const& statistics,
                                   std::vector<std::optional<RunRecord>> const& records, std::size_t most) {
    struct Ranked {
        double rank{0};
        WorstCase what;
    };
    std::vector<Ranked> ranked;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (!records[i]) {
            continue;
        }
        RunRecord const& record = *records[i];
        if (record.exit > 1) {
            ranked.push_back({INFINITY, {i, record.cause}});
            continue;
        }
        double worst = record.exit == 1 ? 0 : -INFINITY;
        std::string why = record.cause;
        for (ResultStatistics const& s : statistics) {
            RunRecord::Value const* const v = record.find(s.name);
            auto const by = v == nullptr ? std::nullopt : excess(s, *v);
            if (by && !v->advisory && *by > worst) {
                worst = *by;
                bool const low = v->low && (!v->high || *v->low - *v->value > *v->value - *v->high);
                why = fmt::format("{} is {:.6g}{}, and the limit {:.6g}", s.name, *v->value,
                                  v->unit.empty() ? "" : " " + v->unit, low ? *v->low : *v->high);
            }
        }
        if (std::isfinite(worst)) {
            // A failed condition has no distance; it is no better than a limit that is only just passed.
            ranked.push_back({record.exit == 1 ? 1e6 + worst : worst, {i, why}});
        }
    }
    std::stable_sort(ranked.begin(), ranked.end(), [](Ranked const& a, Ranked const& b) { return a.rank > b.rank; });
    std::vector<WorstCase> out;
    for (Ranked& r : ranked) {
        if (out.size() == most) {
            break;
        }
        out.push_back(std::move(r.what));
    }
    return out;
}

} // namespace gridspace::launcher
