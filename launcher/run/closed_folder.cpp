// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/closed_folder.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;

bool leads_out(fs::path const& link, fs::path const& folder) {
    std::error_code error;
    fs::path const target = fs::canonical(link, error); // fails where there is nothing: a write would make it
    return error || std::mismatch(folder.begin(), folder.end(), target.begin(), target.end()).first != folder.end();
}

} // namespace

Result<void> check_closed(fs::path const& folder) {
    std::error_code error;
    fs::path const inside = fs::canonical(folder, error);
    for (auto it = fs::recursive_directory_iterator{inside, error}; !error && it != fs::recursive_directory_iterator{};
         it.increment(error)) {
        std::error_code gone; // a run that is under way removes files
        fs::file_type const type = it->symlink_status(gone).type();
        bool const is_link = type == fs::file_type::symlink;
        if (is_link && leads_out(it->path(), inside)) {
            return fail(ExitCode::usage,
                        fmt::format("'{}' is a symbolic link to '{}', which is not in the run's folder",
                                    it->path().string(), fs::read_symlink(it->path(), gone).string()),
                        "`gridspace run` makes none: remove the link, or put the file in its place");
        }
        if (!is_link && type != fs::file_type::regular && type != fs::file_type::directory &&
            type != fs::file_type::socket && type != fs::file_type::not_found) {
            return fail(ExitCode::usage, fmt::format("'{}' is a pipe or a device", it->path().string()),
                        "`gridspace run` makes none: remove it");
        }
    }
    return error
               ? fail(ExitCode::usage, fmt::format("cannot read the folder '{}': {}", folder.string(), error.message()))
               : Result<void>{};
}

} // namespace gridspace::launcher
