// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace monitor RUN: the dashboard on a finished run; gridspace monitor --domain N: on all its participants.
// gridspace-monitor takes the place of this process.
#include "common/config/yaml.hpp"
#include "launcher/cli/become.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/listening.hpp"
#include "launcher/scenario/installation.hpp"
#include "monitor/app/foreign_idl.hpp"
#include "monitor/web/listening.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace gridspace::cli {
namespace {

constexpr int kHandedSocket = 4; ///< where gridspace-monitor looks for a listening socket

/// Names of what is shown, and no more, of what a run has kept for its monitor
/// (launcher/scenario/monitor_settings.hpp): the folder may be a stranger's, and what else stands there is not obeyed.
config::Node configuration_to_show(config::Node const& kept, std::filesystem::path const& folder) {
    using config::Node;
    Node const* const settings = kept.find("settings");
    Node const* const scenario = settings == nullptr ? nullptr : settings->find("scenario");
    Node const* const plan = settings == nullptr ? nullptr : settings->find("run");
    Node run = plan != nullptr && plan->is_map() ? *plan : Node::map();
    run.set("events", Node::quoted_text(folder / "events.ndjson"));
    run.set("graph", Node::quoted_text(folder / "graph.json"));
    if (Node* const processes = run.find("processes")) {
        for (Node& process : processes->items) {
            process.erase("pid_file");
        }
    }
    Node management = Node::map(), bus = Node::map(), shown = Node::map(), out = Node::map();
    management.set("domain", Node::scalar("0")); // it is not joined
    bus.set("management", std::move(management));
    shown.set("scenario", scenario == nullptr ? Node::quoted_text("") : Node::quoted_text(scenario->text));
    shown.set("recording", Node::quoted_text(folder / "data.mcap"));
    shown.set("run", std::move(run));
    out.set("process", Node::scalar("monitor"));
    out.set("program", Node::scalar("gridspace-monitor"));
    out.set("bus", std::move(bus));
    out.set("settings", std::move(shown));
    return out;
}

/// A configuration in a file that is only in memory and goes with the process that reads it.
Result<std::string> in_memory(std::string_view text) {
    int const fd = ::memfd_create("gridspace-monitor.yaml", 0);
    int const high = fd < 0 ? -1 : ::fcntl(fd, F_DUPFD, kHandedSocket + 1); // out of the way of the socket
    for (std::size_t done = 0; high >= 0 && done < text.size();) {
        ssize_t const size = ::write(high, text.data() + done, text.size() - done);
        if (size < 0) {
            return fail(ExitCode::environment,
                        fmt::format("cannot keep a configuration in memory: {}", std::strerror(errno)));
        }
        done += static_cast<std::size_t>(size);
    }
    return high < 0 ? fail(ExitCode::environment,
                           fmt::format("cannot keep a configuration in memory: {}", std::strerror(errno)))
                    : Result<std::string>{fmt::format("/proc/self/fd/{}", high)};
}

/// The configuration of a monitor that shows a finished run.
Result<std::string> configuration_of_run(std::filesystem::path const& run) {
    auto const folder = closed_run(run);
    if (!folder) {
        return std::unexpected{folder.error()};
    }
    std::error_code ignored;
    for (char const* name : {"monitor.yaml", "data.mcap"}) {
        if (!std::filesystem::exists(*folder / name, ignored)) {
            bool const no_run = !std::filesystem::exists(*folder / "manifest.json", ignored);
            return std::unexpected{
                Error{ExitCode::usage,
                      no_run ? fmt::format("'{}' is not the folder of a run", folder->string())
                             : fmt::format("the run '{}' has no {}", folder->string(), name),
                      no_run ? "give one that `gridspace run` has written, or latest"
                             : "only a run that was recorded (program: gridspace-recorder) can be looked at again"}};
        }
    }
    config::Diagnostics diagnostics;
    auto const kept = config::load_yaml(*folder / "monitor.yaml", diagnostics);
    if (!kept || !diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    return in_memory(to_yaml(configuration_to_show(*kept, std::filesystem::absolute(*folder))));
}

/// The configuration of a monitor for a DDS domain.
Result<std::string> configuration_of_domain(int domain, std::vector<std::string> const& addresses) {
    return in_memory(nlohmann::json{{"process", "monitor"},
                                    {"program", "gridspace-monitor"},
                                    {"bus",
                                     {{"qos", launcher::qos_file("monitor").string()},
                                      {"management", {{"domain", domain}, {"addresses", addresses}}}}},
                                    {"settings", {{"scenario", fmt::format("DDS domain {}", domain)}}}}
                         .dump());
}

} // namespace

int monitor(MonitorArguments const& arguments) {
    auto const config = arguments.domain ? configuration_of_domain(*arguments.domain, arguments.addresses)
                                         : configuration_of_run(arguments.run);
    if (!config) {
        return print_error(config.error());
    }
    if (arguments.tls_cert.empty() != arguments.tls_key.empty()) {
        return print_error({ExitCode::usage, "a certificate goes with its key", "give --tls-cert and --tls-key"});
    }
    bool const tls = !arguments.tls_cert.empty();
    if (auto ok = web::check_exposure(arguments.listen, !arguments.token_file.empty(), tls); !ok) {
        return print_error(ok.error());
    }
    if (!arguments.idl.empty()) { // nobody looks at an address where nothing will answer
        if (auto const idl = gridspace::monitor::read_foreign_idl(arguments.idl); !idl) {
            return print_error(idl.error());
        }
    }
    auto socket = launcher::open_listening(arguments.listen);
    if (!socket) {
        return print_error(socket.error());
    }
    fmt::print("{}://{}\n", tls ? "https" : "http", socket->address);
    std::fflush(stdout);
    if (socket->fd.get() == kHandedSocket) {
        ::fcntl(kHandedSocket, F_SETFD, 0);
    } else {
        ::dup2(socket->fd.get(), kHandedSocket); // the copy stays open over exec
    }
    std::string const program = launcher::program_file("gridspace-monitor").string();
    std::vector<std::string> words{program, "--config", *config, "--log-level", "warning"};
    for (auto const& [option, file] :
         {std::pair{"--token-file", &arguments.token_file}, std::pair{"--tls-cert", &arguments.tls_cert},
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
    leave_profiles_aside();
    ::execv(program.c_str(), argv.data());
    return print_error({ExitCode::environment, fmt::format("cannot start '{}': {}", program, std::strerror(errno)),
                        "is Gridspace built completely?"});
}

void add_monitor(Command app, Action& action) {
    auto const a = std::make_shared<MonitorArguments>();
    Command verb = app.add_subcommand("monitor", "look at a finished run, or at any DDS domain, in the dashboard");
    Option monitored_run = verb.add_option("RUN", a->run, "run folder (default: latest)");
    Option domain = verb.add_option("--domain", a->domain, "a DDS domain instead of a run: whoever talks there")
                        .check(in_range(0, 232))
                        .excludes(monitored_run);
    verb.add_option("--address", a->addresses,
                    "address of this machine at which it joins the domain (default: 127.0.0.1; may be repeated)")
        .check(ipv4_address())
        .repeated()
        .needs(domain);
    verb.add_option("--bind,--listen", a->listen,
                    "address and port (port 0: a free one); elsewhere than 127.0.0.1 only with a token and TLS");
    verb.add_option("--token-file", a->token_file, "file with the secret of whoever may look (mode 0600)");
    Option certificate = verb.add_option("--tls-cert", a->tls_cert, "certificate (PEM)");
    verb.add_option("--tls-key", a->tls_key, "its key (PEM)").needs(certificate);
    verb.add_option("--idl", a->idl, "IDL of foreign types").check(existing_file());
    verb.callback([a, &action] { action = [a] { return monitor(*a); }; });
}

} // namespace gridspace::cli
