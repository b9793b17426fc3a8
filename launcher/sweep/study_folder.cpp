// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_folder.hpp"

#include "launcher/scenario/installation.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {

namespace fs = std::filesystem;

std::string shell_word(std::string const& text) {
    constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=+:@%";
    if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) {
        return text;
    }
    std::string out = "'";
    for (char const c : text) {
        out += c == '\'' ? "'\\''" : std::string(1, c);
    }
    return out + "'";
}

std::string StudyFolder::command(std::string const& key) const {
    return fmt::format("{} run {}", shell_word(program_file("gridspace").string()), shell_word(scenario(key).string()));
}

std::vector<std::string> begin_run(StudyFolder const& folder, std::string const& key) {
    std::error_code ignored;
    fs::remove_all(folder.run(key), ignored);
    fs::remove(folder.record(key), ignored);
    return {program_file("gridspace").string(), "run",    folder.scenario(key).string(), "--out",
            folder.run(key).string(),           "--quiet"};
}

Result<RunRecord> end_run(StudyFolder const& folder, std::string const& key, int exit, double wall_s, bool keep) {
    RunRecord record = collect_run(folder.run(key), folder.output(key), exit, wall_s);
    record.is_kept = record.exit != 0 || keep;
    if (auto ok = write_record(folder.record(key), record); !ok) {
        return std::unexpected{ok.error()};
    }
    if (!record.is_kept) {
        std::error_code ignored;
        fs::remove_all(folder.run(key), ignored);
        fs::remove(folder.output(key), ignored);
    }
    return record;
}

} // namespace gridspace::launcher
