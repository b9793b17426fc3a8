// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/manifest.hpp"

#include "common/json_value.hpp"
#include "common/time.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace gridspace::cli {

namespace {

using Json = nlohmann::ordered_json;

} // namespace

Json manifest_of(std::filesystem::path const& folder) {
    std::ifstream stream{folder / "manifest.json"};
    return Json::parse(stream, nullptr, false);
}

double reached_of(Json const& manifest) {
    return value_of(manifest, "simulated_s", 0.0);
}

std::string clock_of(Json const& manifest, char const* key) {
    return value_of(part_of(manifest, "clock"), key, std::string{});
}

std::optional<std::int64_t> epoch_of(Json const& manifest) {
    return parse_utc(clock_of(manifest, "epoch"));
}

std::filesystem::path recording_of(std::filesystem::path const& run) {
    std::error_code ignored;
    return std::filesystem::is_directory(run, ignored) ? run / "data.mcap" : run;
}

} // namespace gridspace::cli
