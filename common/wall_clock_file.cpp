// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/wall_clock_file.hpp"

#include "common/log.hpp"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace gridspace {

void write_wall_clock(std::string const& name, std::vector<NamedDurations> const& all) {
    std::string rows;
    for (auto const& [prefix, durations] : all) {
        if (durations->count() > 0) {
            rows += fmt::format("{0}p50,us,{1:.1f}\n{0}p99,us,{2:.1f}\n{0}max,us,{3:.1f}\n", prefix,
                                durations->percentile_us(0.5), durations->percentile_us(0.99), durations->longest_us());
        }
    }
    char const* const folder = std::getenv("GRIDSPACE_RUN_FOLDER");
    if (rows.empty() || folder == nullptr) {
        return;
    }
    std::filesystem::path const file = std::filesystem::path{folder} / "wall_clock" / (name + ".csv");
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    std::ofstream stream{file, std::ios::trunc};
    stream << "signal,unit,value\n" << rows;
    if (!stream.flush()) {
        log::warning("cannot write '{}': the report will not say how long it took", file.string());
    }
}

} // namespace gridspace
