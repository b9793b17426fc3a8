// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/result_table.hpp"

#include <fmt/format.h>
#include <memory>
#include <sqlite3.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Cell = ResultTable::Cell;
using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

std::string quoted(std::string const& name) { // names of parameters and results are identifiers; `order` is one
    return "\"" + name + "\"";
}

bool run(sqlite3* database, std::string const& sql) {
    return sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
}

int bind(sqlite3_stmt* statement, int place, Cell const& cell) {
    if (auto const* real = std::get_if<double>(&cell)) {
        return sqlite3_bind_double(statement, place, *real);
    }
    if (auto const* whole = std::get_if<std::int64_t>(&cell)) {
        return sqlite3_bind_int64(statement, place, *whole);
    }
    if (auto const* text = std::get_if<std::string>(&cell)) {
        return sqlite3_bind_text(statement, place, text->data(), static_cast<int>(text->size()), SQLITE_TRANSIENT);
    }
    return sqlite3_bind_null(statement, place);
}

bool fill(sqlite3* database, ResultTable const& table) {
    std::string columns, places;
    for (std::string const& name : table.columns) {
        columns += (columns.empty() ? "" : ", ") + quoted(name);
        places += places.empty() ? "?" : ", ?";
    }
    if (!run(database, "BEGIN; CREATE TABLE runs (" + columns + ")")) {
        return false;
    }
    sqlite3_stmt* made = nullptr;
    std::string const insert = "INSERT INTO runs VALUES (" + places + ")";
    if (sqlite3_prepare_v2(database, insert.c_str(), -1, &made, nullptr) != SQLITE_OK) {
        return false;
    }
    Statement const statement{made, &sqlite3_finalize};
    for (auto const& row : table.rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (bind(made, static_cast<int>(i + 1), row[i]) != SQLITE_OK) {
                return false;
            }
        }
        if (sqlite3_step(made) != SQLITE_DONE || sqlite3_reset(made) != SQLITE_OK) {
            return false;
        }
    }
    return run(database, "COMMIT");
}

} // namespace

Result<void> write_database(std::filesystem::path const& file, ResultTable const& table) {
    std::filesystem::path const fresh = file.string() + fmt::format(".{}", ::getpid());
    std::error_code error;
    std::filesystem::remove(fresh, error);
    sqlite3* made = nullptr;
    bool const is_open = sqlite3_open(fresh.c_str(), &made) == SQLITE_OK;
    {
        Database const database{made, &sqlite3_close};
        // The whole file is thrown away when anything fails: no journal is needed.
        if (!is_open || !run(made, "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF") || !fill(made, table)) {
            std::string const why = made == nullptr ? "no memory" : sqlite3_errmsg(made);
            std::filesystem::remove(fresh, error);
            return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", file.string(), why));
        }
    }
    std::filesystem::rename(fresh, file, error);
    return error ? fail(ExitCode::environment, fmt::format("cannot write '{}': {}", file.string(), error.message()))
                 : Result<void>{};
}

} // namespace gridspace::launcher
