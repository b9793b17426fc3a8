// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace monitor RUN: the dashboard on a finished run. gridspace-monitor takes the place of this process.
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/installation.hpp"
#include "launcher/run/listening.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace gridspace::cli {
namespace {

constexpr int kHandedSocket = 4; ///< where gridspace-monitor looks for a listening socket

} // namespace

int monitor(MonitorArguments const& arguments) {
    std::filesystem::path const folder = run_folder(arguments.run);
    std::error_code ignored;
    for (char const* name : {"monitor.yaml", "data.mcap"}) {
        if (!std::filesystem::exists(folder / name, ignored)) {
            bool const no_run = !std::filesystem::exists(folder / "manifest.json", ignored);
            return print_error(
                {ExitCode::usage,
                 no_run ? fmt::format("'{}' is not the folder of a run", folder.string())
                        : fmt::format("the run '{}' has no {}", folder.string(), name),
                 no_run ? "give one that `gridspace run` has written, or latest"
                        : "only a run that was recorded (program: gridspace-recorder) can be looked at again"});
        }
    }
    auto socket = launcher::open_listening(arguments.listen);
    if (!socket) {
        return print_error(socket.error());
    }
    fmt::print("http://{}\n", socket->address);
    std::fflush(stdout);
    if (socket->fd == kHandedSocket) {
        ::fcntl(kHandedSocket, F_SETFD, 0);
    } else {
        ::dup2(socket->fd, kHandedSocket); // the copy stays open over exec
    }
    std::string const program = launcher::program_file("gridspace-monitor").string(),
                      config = (folder / "monitor.yaml").string();
    ::execl(program.c_str(), program.c_str(), "--config", config.c_str(), "--log-level", "warning", nullptr);
    return print_error({ExitCode::environment, fmt::format("cannot start '{}': {}", program, std::strerror(errno)),
                        "is Gridspace built completely?"});
}

} // namespace gridspace::cli
