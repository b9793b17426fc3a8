// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/result_table.hpp"

#include "common/text.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using Cell = ResultTable::Cell;

Cell number_or_text(config::Node const& value) {
    auto const number = value.quoted ? std::nullopt : config::number_of(value);
    return number ? Cell{*number} : Cell{cell_text(value)};
}

std::string csv_cell(Cell const& cell) {
    struct Text {
        std::string operator()(std::monostate) const { return ""; }
        std::string operator()(double v) const { return shortest(v); }
        std::string operator()(std::int64_t v) const { return std::to_string(v); }
        std::string operator()(std::string const& v) const {
            if (v.find_first_of(",\"\n\r") == std::string::npos) {
                return v;
            }
            std::string out = "\"";
            for (char const c : v) {
                out += c == '"' ? "\"\"" : std::string(1, c);
            }
            return out + "\"";
        }
    };
    return std::visit(Text{}, cell);
}

} // namespace

ResultTable make_table(Study const& study, StudyPlan const& plan, std::vector<std::optional<RunRecord>> const& records,
                       StudyFolder const& folder) {
    ResultTable table;
    table.columns = {"run", "key"};
    for (Parameter const& p : study.parameters) {
        table.columns.push_back(p.name.name);
    }
    for (char const* name : {"repetition", "seed", "state", "exit", "cause", "wall_s", "simulated_s"}) {
        table.columns.emplace_back(name);
    }
    table.columns.insert(table.columns.end(), plan.results.begin(), plan.results.end());
    table.columns.insert(table.columns.end(), {"folder", "command"});
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        StudyRun const& run = plan.runs[i];
        std::vector<Cell> row{static_cast<std::int64_t>(i + 1), run.key};
        for (config::Node const& value : run.point) {
            row.push_back(number_or_text(value));
        }
        row.insert(row.end(), {run.repetition, run.seed});
        auto const& record = records[i];
        if (record) {
            row.insert(row.end(), {std::string{record->state()}, static_cast<std::int64_t>(record->exit), record->cause,
                                   record->wall_s, record->simulated_s});
        } else {
            row.insert(row.end(), {std::string{"open"}, Cell{}, std::string{}, Cell{}, Cell{}});
        }
        for (std::string const& name : plan.results) {
            RunRecord::Value const* const value = record ? record->find(name) : nullptr;
            row.push_back(value != nullptr && value->value && std::isfinite(*value->value) ? Cell{*value->value}
                                                                                           : Cell{});
        }
        row.insert(row.end(),
                   {record && record->is_kept ? Cell{folder.run(run.key).string()} : Cell{}, folder.command(run.key)});
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string to_csv(ResultTable const& table) {
    std::string out = join(table.columns, ",") + "\n";
    for (auto const& row : table.rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            out += (i == 0 ? "" : ",") + csv_cell(row[i]);
        }
        out += "\n";
    }
    return out;
}

} // namespace gridspace::launcher
