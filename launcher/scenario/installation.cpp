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
    std::error_code ignored;
    std::filesystem::path const installed = own_folder().parent_path() / "share/gridspace/qos" / name;
    return std::filesystem::exists(installed, ignored) ? installed : std::filesystem::path{source_tree("qos")} / name;
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
