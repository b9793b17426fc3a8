// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/wall_clock.hpp"

#include "common/config/fields.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace gridspace::launcher {

void add_wall_clock_values(std::filesystem::path const& folder, double end_s, SignalStore& signals) {
    std::error_code ignored;
    std::vector<std::filesystem::path> files;
    for (auto const& entry : std::filesystem::directory_iterator{folder / "wall_clock", ignored}) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (std::filesystem::path const& file : files) {
        std::ifstream stream{file};
        for (std::string line; std::getline(stream, line);) {
            std::vector<std::string> const cells = split(line, ',');
            auto const value = cells.size() == 3 ? config::number_of(config::Node::scalar(cells[2])) : std::nullopt;
            if (value) { // the header has none
                signals[cells[0]] = {cells[1], {std::llround(end_s * 1e9)}, {*value}};
            }
        }
    }
}

} // namespace gridspace::launcher
