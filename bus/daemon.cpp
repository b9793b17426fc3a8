// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/daemon.hpp"

#include "bus/unauthenticated.hpp"
#include "common/command_line/command.hpp"
#include "common/config/merge.hpp"
#include "common/log.hpp"
#include "common/privileges/call_filter.hpp"
#include "common/realtime.hpp"
#include "common/version.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <optional>
#include <pthread.h>
#include <string>
#include <sys/prctl.h>
#include <thread>

namespace gridspace {
namespace {

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    return set;
}

/// Waits for SIGINT and SIGTERM on a thread of its own; a second one ends the process at once.
class SignalWatcher {
  public:
    SignalWatcher() {
        sigset_t const set = stop_signals();
        pthread_sigmask(SIG_BLOCK, &set, nullptr); // inherited by every thread that comes later
        std::signal(SIGPIPE, SIG_IGN);
        thread_ = std::thread{[this, set] { watch(set); }};
    }
    ~SignalWatcher() {
        ending_ = true;
        pthread_kill(thread_.native_handle(), SIGTERM);
        thread_.join();
    }
    SignalWatcher(SignalWatcher const&) = delete;
    SignalWatcher& operator=(SignalWatcher const&) = delete;

    void on_stop(std::function<void()> stop) {
        std::lock_guard const lock{mutex_};
        stop_ = std::move(stop);
        if (received_ && stop_) {
            stop_();
        }
    }
    [[nodiscard]] bool received() const { return received_; }

  private:
    void watch(sigset_t const& set) {
        while (true) {
            int signal = 0;
            sigwait(&set, &signal);
            if (ending_) {
                return;
            }
            if (received_.exchange(true)) {
                std::_Exit(static_cast<int>(ExitCode::interrupted));
            }
            std::lock_guard const lock{mutex_};
            if (stop_) {
                stop_();
            }
        }
    }

    std::mutex mutex_;
    std::function<void()> stop_;
    std::atomic<bool> received_{false}, ending_{false};
    std::thread thread_;
};

struct Options {
    std::string config;
    bool check{false};
    int status_fd{-1};
    std::string log_level{"info"};
};

program::Declaration declaration_of(Daemon const& daemon) {
    program::Declaration out = daemon.declaration
                                   ? daemon.declaration()
                                   : program::Declaration{.name = std::string{daemon.program},
                                                          .description = std::string{daemon.description},
                                                          .settings = config::keys_of(daemon.describe_settings)};
    out.daemon = true;
    return out;
}

/// The exit code when the process shall end here (--help, a mistake), nothing otherwise.
std::optional<int> parse(Daemon const& daemon, int argc, char** argv, Options& options) {
    command_line::Program program{std::string{daemon.program}, std::string{daemon.description},
                                  version_text(daemon.program)};
    command_line::Command app = program.command();
    app.add_option("--config", options.config, "its configuration (YAML)").required();
    app.add_flag("--check", options.check, "check the configuration and end");
    app.add_flag(
           "--describe",
           [&] {
               fmt::print("{}", program::to_json(declaration_of(daemon), version().version));
               command_line::end_reading();
           },
           "print what it is, its settings, topics and signals as JSON, and end")
        .at_once();
    app.add_option("--log-level", options.log_level, "debug, info, warning or error")
        .check(command_line::one_of({"debug", "info", "warning", "error"}));
    app.add_option("--status-fd", options.status_fd, "file descriptor for status lines (used by `gridspace run`)");
    if (std::optional<int> const code = program.parse(argc, argv)) {
        return code;
    }
    using log::Level;
    log::set_level(options.log_level == "debug"     ? Level::debug
                   : options.log_level == "warning" ? Level::warning
                   : options.log_level == "error"   ? Level::error
                                                    : Level::info);
    return std::nullopt;
}

/// What came from outside and was kept out: for the events of the run and its report.
void tell_of_strangers(bus::Node const& node, StatusReporter& status) {
    double const now_s = node.lockstep() ? node.time_base().seconds(node.latest_time()) : 0;
    auto const say = [&](std::string const& text) {
        log::warning("{}", text);
        status.event(now_s, node.config().process, "foreign_frames", text);
    };
    for (auto const& [link, ethertype, frames, not_fetched] : node.foreign_frames_by_link()) {
        if (frames.total() > 0) {
            say(fmt::format("{} frames of ethertype {:#06x} on '{}' that no process of the run has "
                            "announced, and that nobody took: {}",
                            frames.total(), ethertype, link, frames.text()));
        }
        if (not_fetched > 0) {
            say(fmt::format("{} frames on '{}' from addresses that are not of this run came faster than they could be "
                            "looked at",
                            not_fetched, link));
        }
    }
    for (auto const& [process, samples] : node.impostor_samples()) {
        std::string const text =
            fmt::format("{} samples of somebody who calls himself '{}', and is not the '{}' of this run: not obeyed",
                        samples, process, process);
        log::warning("{}", text);
        status.event(now_s, node.config().process, "impostor", text);
    }
    if (std::string const refused = node.refused_datagrams(); !refused.empty()) {
        status.event(now_s, node.config().process, "foreign_datagrams",
                     "datagrams that were kept from DDS: " + refused); // its participants log it
    }
}

/// Reads the file: who the process is, its place on the bus, its settings.
bool read(Daemon const& daemon, Options const& options, bus::NodeConfig& node, config::Diagnostics& diagnostics) {
    auto const root = config::load_extended(options.config, diagnostics);
    if (!root) {
        return false;
    }
    config::SourceMark qos_at;
    config::read_fields(*root, "", diagnostics, [&](config::Fields& f) {
        f.text("process", node.process, {.doc = "name of this process in the run", .required = true});
        node.program = daemon.program;
        std::string program{daemon.program};
        f.text("program", program, {.doc = "the program that the file is for"});
        if (program != daemon.program) {
            f.error("program", fmt::format("this file is for {}, and this is {}", program, daemon.program));
        }
        f.object("bus", {.doc = "its place on the bus and in the simulation clock", .required = true},
                 [&](config::Fields& b) {
                     describe(b, node);
                     if (node.qos.empty() && daemon.joins_always) {
                         b.error("", "no QoS profiles are named",
                                 "qos: FILE, of the folder `qos` of the installation or the source tree");
                     }
                     qos_at = b.where("qos");
                 });
        bool const given = f.object("settings", {.doc = "what the program itself does"}, daemon.describe_settings);
        if (!given) { // required settings are still missed
            config::Node const empty = config::Node::map(root->where);
            config::read_fields(empty, "settings", diagnostics, daemon.describe_settings);
        }
    });
    std::error_code ignored;
    if (!node.qos.empty() && !std::filesystem::is_regular_file(node.qos, ignored)) { // it may be on another machine
        diagnostics.warning(qos_at, fmt::format("there is no file '{}'", node.qos.string()),
                            "the QoS profiles are in the folder `qos` of the installation or the source tree");
    }
    if (diagnostics.ok() && daemon.check) {
        daemon.check(diagnostics);
    }
    return diagnostics.ok();
}

/// Fast DDS would sleep for 100 ms at the end of each process (RTPSDomain::stopAll), with nothing left to stop.
[[noreturn]] void leave(int code) {
#ifdef GRIDSPACE_CHECKED_AT_EXIT // what a sanitizer has to say, it says then
    std::exit(code);
#else
    std::fflush(nullptr);
    std::_Exit(code);
#endif
}

/// The whole of a daemon's life; its exit code.
int live(Daemon const& daemon, int argc, char** argv) {
    SignalWatcher signals; // before anything else: an interrupt during start-up is orderly too
    Options options;
    if (auto const code = parse(daemon, argc, argv, options)) {
        return *code;
    }
    StatusReporter status{options.status_fd};
    bus::NodeConfig node;
    config::Diagnostics diagnostics;
    bool const readable = read(daemon, options, node, diagnostics);
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        fmt::print(stderr, "{}\n", diagnostics.render());
    }
    if (!readable) {
        status.failed(
            {ExitCode::usage, fmt::format("its configuration '{}' is not valid", options.config), "see its log"});
        return static_cast<int>(ExitCode::usage);
    }
    if (options.check) {
        fmt::print("{}: valid\n", options.config);
        return 0;
    }
    prctl(PR_SET_NAME, std::string{daemon.program}.substr(0, 15).c_str()); // what ps and pgrep show
    if (node.clock.mode == bus::ClockMode::realtime) {
        std::string const why_not = lock_memory();
        log::info("{}; {}", scheduling_text(),
                  why_not.empty() ? "memory is locked" : "memory is not locked: " + why_not);
    }
    if (daemon.is_ours && !allow_only_known_calls()) {
        log::debug("this kernel has no filters of system calls");
    }
    node.is_daemon = daemon.is_ours;
    DaemonRun run{std::move(node), status,
                  [&signals](std::function<void()> stop) { signals.on_stop(std::move(stop)); }};
    Result<void> const result = daemon.run(run);
    signals.on_stop({});
    if (result) {
        return 0;
    }
    if (signals.received()) {
        // All were asked to end: that the simulator or a member has gone is what was asked for, whoever was faster.
        bool const others_ended_first = result.error().code == ExitCode::child_died;
        return others_ended_first ? 0 : static_cast<int>(ExitCode::interrupted);
    }
    log::error("{}", describe(result.error()));
    status.failed(result.error());
    return static_cast<int>(result.error().code);
}

} // namespace

int run_daemon(Daemon const& daemon, int argc, char** argv) {
    int const code = live(daemon, argc, argv);
    if (daemon.is_ours) {
        leave(code);
    }
    return code; // libgridspace leaves the process to its owner
}

Result<void> run_on_bus(DaemonRun& run, std::function<Result<void>(bus::Node&)> const& body) {
    std::atomic<bus::Node*> there{nullptr};
    struct NobodyIsTold {
        ~NobodyIsTold() { bus::on_unauthenticated({}); }
    };
    bus::on_unauthenticated([&](std::string const& text) {
        bus::Node const* const now = there;
        run.status.event(now != nullptr && now->lockstep() ? now->time_base().seconds(now->latest_time()) : 0,
                         run.bus.process, "unauthenticated_participant", text);
    });
    NobodyIsTold const nobody_after_this;
    auto node = bus::Node::create(run.bus);
    if (!node) {
        return std::unexpected{node.error()};
    }
    NobodyIsTold const nobody_without_node; // ends before the node does
    there = node->get();
    (*node)->on_ready([&run] { run.status.matched(); });
    run.on_stop([&node] { (*node)->request_stop(); });
    auto result = body(**node);
    run.on_stop({});
    if (!result && result.error().code != ExitCode::interrupted) {
        run.status.failed(result.error()); // before its dispose on the bus ends the others, which would be blamed
    }
    tell_of_strangers(**node, run.status);
    return result;
}

} // namespace gridspace
