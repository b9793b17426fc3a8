// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/installation.hpp"

#include "common/source_tree.hpp"
#include "common/text.hpp"

#include <cstdlib>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

std::filesystem::path own_folder() {
    std::error_code ignored;
    return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
}

} // namespace

std::filesystem::path program_file(std::string_view program) {
    return own_folder() / program;
}

std::filesystem::path qos_file(std::string_view role) {
    std::string const name = std::string{role} + ".xml";
    if (char const* folder = std::getenv("GRIDSPACE_QOS_DIR"); folder != nullptr) {
        return std::filesystem::path{folder} / name;
    }
    return shared_folder("qos") / name;
}

std::filesystem::path prefix_folder() {
    return own_folder().parent_path();
}

std::filesystem::path grid_library() {
    constexpr std::string_view kName = "gridspace_grid.so";
    std::error_code ignored;
    for (char const* folder : {"lib/gridspace", GRIDSPACE_LIBRARY_FOLDER "/gridspace"}) {
        std::filesystem::path installed = prefix_folder() / folder / kName;
        if (std::filesystem::exists(installed, ignored)) {
            return installed;
        }
    }
    return prefix_folder() / "lib" / kName; // of a build
}

std::filesystem::path shared_folder(std::string_view name) {
    std::error_code ignored;
    std::filesystem::path const installed = prefix_folder() / "share/gridspace" / name;
    return std::filesystem::exists(installed, ignored) ? installed : std::filesystem::path{source_tree(name)};
}

void offer_agent_libraries() {
    std::error_code ignored;
    std::string python = shared_folder("python").string();
    if (char const* given = std::getenv("PYTHONPATH"); given != nullptr && *given != '\0') {
        python += std::string{":"} + given;
    }
    ::setenv("PYTHONPATH", python.c_str(), 1);
    for (char const* folder : {"lib", GRIDSPACE_LIBRARY_FOLDER}) {
        std::filesystem::path const library = prefix_folder() / folder / "libgridspace.so.1";
        if (std::filesystem::exists(library, ignored)) {
            ::setenv("GRIDSPACE_LIBRARY", library.c_str(), 0);
        }
    }
}

std::filesystem::path system_program(std::string_view name) {
    std::string folders = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
    folders += ":/usr/sbin:/sbin:/usr/bin:/bin";
    for (std::string const& folder : split(folders, ':')) {
        std::filesystem::path const file = std::filesystem::path{folder} / name;
        if (!folder.empty() && ::access(file.c_str(), X_OK) == 0) {
            return file;
        }
    }
    return {};
}

} // namespace gridspace::launcher
