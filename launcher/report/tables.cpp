// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/tables.hpp"

#include "common/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace gridspace::launcher {
namespace {

using Column = TableSettings::Column;

/// The values of a column; NaN where there is none.
std::vector<double> values_of(Column const& column, TableSettings const& table,
                              std::vector<std::vector<double>> const& before, Results const& r) {
    std::vector<double> out(table.rows.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < out.size(); ++row) {
        if (row < column.values.size()) {
            out[row] = column.values[row];
        } else if (row < column.measured.size()) {
            ExpectationResult const answer =
                judge(column.measured[row], r.signals, r.moments, r.outcome.simulated_s, r.mode == "lockstep");
            out[row] = answer.value.value_or(out[row]);
        } else if (column.calculated) {
            Expression::Bindings bindings;
            std::vector<double> values;
            for (std::string const& used : column.calculated->signals()) {
                std::size_t other = 0;
                while (other < before.size() && "column." + table.columns[other].name != used) {
                    ++other;
                }
                bindings.push_back({values.size()});
                values.push_back(other < before.size() ? before[other][row] : out[row]);
            }
            out[row] = column.calculated->evaluate(bindings, values);
        }
    }
    return out;
}

} // namespace

std::vector<ReportTable> make_tables(ReportSettings const& settings, Results const& r) {
    std::vector<ReportTable> out;
    for (TableSettings const& table : settings.tables) {
        ReportTable drawn{table.title, {table.row_header}, {}, table.note};
        std::vector<std::vector<double>> columns;
        for (Column const& column : table.columns) {
            drawn.header.push_back(column.header);
            columns.push_back(values_of(column, table, columns, r));
        }
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            std::vector<std::string> cells{escape_markup(table.rows[row].name)};
            for (std::size_t c = 0; c < columns.size(); ++c) {
                double const v = columns[c][row];
                bool const given = !table.columns[c].values.empty();
                cells.push_back(!std::isfinite(v) ? "–"
                                : given           ? shortest(v)
                                                  : fmt::format("{:.{}f}", v, table.columns[c].digits));
            }
            drawn.rows.push_back(std::move(cells));
        }
        out.push_back(std::move(drawn));
    }
    return out;
}

} // namespace gridspace::launcher
