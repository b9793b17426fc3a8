// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/become.hpp"

#include "launcher/cli/load.hpp"
#include "launcher/scenario/installation.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace gridspace::cli {

void leave_profiles_aside() {
    ::setenv("SKIP_DEFAULT_XML_FILE", "1", 1);
    ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
}

int become(std::string_view program, std::string_view qos_role, std::vector<std::string> arguments) {
    std::string file = launcher::program_file(program).string();
    std::string qos = launcher::qos_file(qos_role).string();
    std::string qos_option = "--qos";
    std::vector<char*> argv{file.data(), qos_option.data(), qos.data()};
    for (std::string& word : arguments) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    leave_profiles_aside();
    ::execv(file.c_str(), argv.data());
    return print_error({ExitCode::environment, fmt::format("cannot start '{}': {}", file, std::strerror(errno)),
                        "is Gridspace built completely?"});
}

} // namespace gridspace::cli
