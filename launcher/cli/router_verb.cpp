// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace router CONFIG: gridspace-router takes the place of this process.
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/installation.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>
#include <vector>

namespace gridspace::cli {

int router(RouterArguments const& arguments) {
    std::string const program = launcher::program_file("gridspace-router").string();
    std::vector<std::string> words{program, "--config", arguments.config.string(), "--qos",
                                   launcher::qos_file("router").string()};
    if (arguments.check) {
        words.emplace_back("--check");
    }
    if (arguments.json) {
        words.emplace_back("--json");
        words.emplace_back("--log-level");
        words.emplace_back("warning");
    }
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    ::setenv("SKIP_DEFAULT_XML_FILE", "1", 1); // a stray Fast DDS profile file must not change what it does
    ::unsetenv("FASTRTPS_DEFAULT_PROFILES_FILE");
    ::execv(program.c_str(), argv.data());
    return print_error({ExitCode::environment, fmt::format("cannot start '{}': {}", program, std::strerror(errno)),
                        "is Gridspace built completely?"});
}

} // namespace gridspace::cli
