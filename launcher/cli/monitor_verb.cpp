// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace monitor RUN: the dashboard on a finished run. gridspace-monitor takes the place of this process.
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/installation.hpp"
#include "launcher/run/listening.hpp"
#include "monitor/web/listening.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>
#include <vector>

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
    if (arguments.tls_cert.empty() != arguments.tls_key.empty()) {
        return print_error({ExitCode::usage, "a certificate goes with its key", "give --tls-cert and --tls-key"});
    }
    bool const tls = !arguments.tls_cert.empty();
    if (auto ok = web::check_exposure(arguments.listen, !arguments.token_file.empty(), tls); !ok) {
        return print_error(ok.error());
    }
    auto socket = launcher::open_listening(arguments.listen);
    if (!socket) {
        return print_error(socket.error());
    }
    fmt::print("{}://{}\n", tls ? "https" : "http", socket->address);
    std::fflush(stdout);
    if (socket->fd == kHandedSocket) {
        ::fcntl(kHandedSocket, F_SETFD, 0);
    } else {
        ::dup2(socket->fd, kHandedSocket); // the copy stays open over exec
    }
    std::string const program = launcher::program_file("gridspace-monitor").string(),
                      config = (folder / "monitor.yaml").string();
    std::vector<std::string> words{program, "--config", config, "--log-level", "warning"};
    for (auto const& [option, file] : {std::pair{"--token-file", &arguments.token_file}, std::pair{"--tls-cert", &arguments.tls_cert},
                                       std::pair{"--tls-key", &arguments.tls_key}, std::pair{"--idl", &arguments.idl}}) {
        if (!file->empty()) {
            words.insert(words.end(), {option, file->string()});
        }
    }
    std::vector<char*> argv;
    for (std::string& word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    ::execv(program.c_str(), argv.data());
    return print_error({ExitCode::environment, fmt::format("cannot start '{}': {}", program, std::strerror(errno)),
                        "is Gridspace built completely?"});
}

} // namespace gridspace::cli
