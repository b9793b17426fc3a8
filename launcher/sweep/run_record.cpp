// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/run_record.hpp"

#include "common/exit_code.hpp"
#include "common/json_value.hpp"
#include "common/text.hpp"
#include "launcher/folder/write_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
std::optional<T> maybe(Json const& object, char const* key) {
    Json const value = value_of(object, key, Json());
    bool const fits = std::is_same_v<T, bool> ? value.is_boolean() : value.is_number();
    return fits ? std::optional{value.get<T>()} : std::nullopt;
}

std::vector<RunRecord::Value> values_of(Json const& list) {
    std::vector<RunRecord::Value> out;
    for (Json const& item : list) {
        out.push_back({text_of(item, "name"), text_of(item, "verb"), text_of(item, "unit"),
                       maybe<double>(item, "value"), maybe<double>(item, "low"), maybe<double>(item, "high"),
                       maybe<bool>(item, "pass"), value_of(item, "advisory", false)});
    }
    return out;
}

Json file_of(std::filesystem::path const& file) {
    std::ifstream stream{file};
    return Json::parse(stream, nullptr, false);
}

/// The last lines of what it printed, on one.
std::string last_words(std::filesystem::path const& output) {
    std::ifstream stream{output};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    std::size_t const error = text.find("error: ");
    std::string const tail =
        error == std::string::npos
            ? text.substr(text.size() - std::min<std::size_t>(text.size(), 300))
            : text.substr(text.rfind('\n', error) == std::string::npos ? 0 : text.rfind('\n', error) + 1, 300);
    std::vector<std::string> lines;
    for (std::string const& line : split(tail, '\n')) {
        if (!trim(line).empty()) {
            lines.emplace_back(trim(line));
        }
    }
    return join(lines, " / ");
}

} // namespace

char const* RunRecord::state() const {
    return exit == 0 ? "passed" : exit == static_cast<int>(ExitCode::expectation_failed) ? "failed" : "ended_early";
}

RunRecord::Value const* RunRecord::find(std::string const& name) const {
    auto const it = std::find_if(values.begin(), values.end(), [&](Value const& v) { return v.name == name; });
    return it == values.end() ? nullptr : &*it;
}

RunRecord collect_run(std::filesystem::path const& run_folder, std::filesystem::path const& output, int exit,
                      double wall_s) {
    RunRecord record;
    record.exit = exit;
    record.wall_s = wall_s;
    Json const summary = file_of(run_folder / "report/summary.json");
    if (!summary.is_object()) {
        record.exit = exit > 1 ? exit : static_cast<int>(ExitCode::child_died);
        record.cause = last_words(output);
        record.cause = record.cause.empty() ? fmt::format("exit code {}, and no report", exit) : record.cause;
        return record;
    }
    record.simulated_s = value_of(summary, "simulated_s", 0.0);
    record.overruns = value_of(summary, "overruns", std::uint64_t{0});
    record.cause = text_of(summary, "cause");
    record.values = values_of(value_of(summary, "expectations", Json::array()));
    std::vector<std::string> failed;
    for (RunRecord::Value const& v : record.values) {
        if (v.passed == false && !v.advisory) {
            failed.push_back(v.name);
        }
    }
    if (record.cause.empty() && !failed.empty()) {
        record.cause = "not as expected: " + join(failed, ", ");
    }
    return record;
}

std::optional<RunRecord> read_record(std::filesystem::path const& file) {
    Json const json = file_of(file);
    if (!json.is_object() || !value_of(json, "exit", Json()).is_number_integer()) {
        return std::nullopt;
    }
    RunRecord record;
    record.exit = value_of(json, "exit", 0);
    record.cause = text_of(json, "cause");
    record.wall_s = value_of(json, "wall_s", 0.0);
    record.simulated_s = value_of(json, "simulated_s", 0.0);
    record.overruns = value_of(json, "overruns", std::uint64_t{0});
    record.is_kept = value_of(json, "kept", false);
    record.values = values_of(value_of(json, "values", Json::array()));
    return record;
}

Result<void> write_record(std::filesystem::path const& file, RunRecord const& record) {
    auto const or_null = [](auto const& v) { return v ? Json(*v) : Json(nullptr); };
    Json values = Json::array();
    for (RunRecord::Value const& v : record.values) {
        values.push_back({{"name", v.name},
                          {"verb", v.verb},
                          {"value", or_null(v.value)},
                          {"unit", v.unit},
                          {"low", or_null(v.low)},
                          {"high", or_null(v.high)},
                          {"pass", or_null(v.passed)},
                          {"advisory", v.advisory}});
    }
    Json const json{{"exit", record.exit},
                    {"cause", record.cause},
                    {"wall_s", record.wall_s},
                    {"simulated_s", record.simulated_s},
                    {"overruns", record.overruns},
                    {"kept", record.is_kept},
                    {"values", values}};
    return replace_file(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

} // namespace gridspace::launcher
