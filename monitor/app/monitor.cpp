// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-monitor: shows a run while it runs. It is never a member of the simulation clock, writes nothing on the bus
// and opens no raw socket: a run is the same with and without it.
#include "bus/daemon.hpp"
#include "common/log.hpp"
#include "monitor/app/api.hpp"
#include "monitor/app/bus_tap.hpp"
#include "monitor/app/event_tail.hpp"
#include "monitor/app/foreign_idl.hpp"
#include "monitor/app/foxglove.hpp"
#include "monitor/app/pages.hpp"
#include "monitor/app/process_use.hpp"
#include "monitor/app/push.hpp"
#include "monitor/app/recorded_run.hpp"
#include "monitor/app/run_plan.hpp"
#include "monitor/graph/graph_text.hpp"
#include "monitor/web/gate.hpp"
#include "monitor/web/guarded.hpp"
#include "monitor/web/server.hpp"

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <vector>

namespace gridspace::monitor {
namespace {

constexpr int kHandedSocket = 4; ///< where `gridspace run` puts a listening socket
constexpr std::chrono::milliseconds kPeriod{50};
constexpr std::chrono::milliseconds kLastWords{700}; ///< of the two seconds that the launcher gives

/// The socket that the launcher opened outside of the run's namespaces, or an own one.
Result<UniqueFd> socket_to_serve_on(MonitorConfig const& config) {
    int listening = 0;
    socklen_t size = sizeof listening;
    if (::getsockopt(kHandedSocket, SOL_SOCKET, SO_ACCEPTCONN, &listening, &size) == 0 && listening != 0) {
        return UniqueFd{kHandedSocket};
    }
    return web::listen_at(config.listen);
}

/// Who may ask, and under which names.
Result<web::Server::Options> options_of(MonitorConfig const& config) {
    web::Server::Options options;
    for (config::Ref const& host : config.allow_hosts) {
        options.sites.hosts.push_back(host.name);
    }
    if (!config.token_file.empty()) {
        auto token = web::read_token(config.token_file);
        if (!token) {
            return std::unexpected{token.error()};
        }
        options.tokens.push_back(std::move(*token));
    }
    if (!config.tls_cert.empty() || !config.tls_key.empty()) {
        options.tls = web::TlsFiles{config.tls_cert, config.tls_key};
    }
    return options;
}

/// The launcher's own word about a run that broke off.
bool ends_the_run(RunEvent const& event) {
    return event.source == "launcher" && (event.event == "run_failed" || event.event == "run_stopped");
}

/// Users of a failed run want to see which process caused it. The launcher logs that before anything else, but this
/// process may be asked to end, and hear of the clock's end, before the line is there.
void last_words(LiveRun& live, EventTail& events) {
    auto const deadline = std::chrono::steady_clock::now() + kLastWords;
    auto const known = [&live] {
        std::lock_guard const lock{live.mutex};
        return live.clock.state == "final" || std::any_of(live.events.rbegin(), live.events.rend(), ends_the_run);
    };
    while (events.read(live), !known() && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
}

/// Wakes the main loop when the process is asked to end.
class Stop {
  public:
    void ask() {
        std::lock_guard const lock{mutex_};
        asked_ = true;
        changed_.notify_all();
    }
    /// True when it was asked for.
    bool wait(std::chrono::milliseconds period) {
        std::unique_lock lock{mutex_};
        return changed_.wait_for(lock, period, [this] { return asked_; });
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool asked_{false};
};

/// Writes the graph into the run folder when it has changed while the run was running, so that the recorded run shows
/// who talked to whom. Returns the revision that is on disk.
std::uint64_t keep_graph(LiveRun const& live, std::uint64_t kept) {
    graph::Snapshot snapshot;
    {
        std::lock_guard const lock{live.mutex};
        if (live.plan.graph.empty() || live.clock.state != "running" || live.graph.revision() == kept) {
            return kept;
        }
        snapshot = live.snapshot();
    }
    std::filesystem::path part = live.plan.graph;
    part += ".part";
    std::ofstream stream{part};
    stream << graph::to_json(snapshot) << '\n';
    stream.close();
    std::error_code error;
    if (stream) {
        std::filesystem::rename(part, live.plan.graph, error);
    }
    return snapshot.revision;
}

/// The IDL of what is foreign to this installation.
Result<void> read_types(MonitorConfig const& config, LiveRun& live) {
    if (!config.idl.empty()) {
        auto foreign = read_foreign_idl(config.idl);
        if (!foreign) {
            return std::unexpected{foreign.error()};
        }
        live.idl = std::move(*foreign);
    }
    for (auto const& [type, file] : config.types) {
        auto own = read_foreign_idl(file);
        if (!own) {
            return std::unexpected{own.error()};
        }
        live.idl.merge(*own);
    }
    return {};
}

Result<std::unique_ptr<BusTap>> join(DaemonRun const& run, LiveRun& live) {
    if (run.bus.qos.empty()) {
        return fail(ExitCode::usage, "no QoS profiles are named",
                    "bus: qos: FILE, of the folder `qos` of the installation or the source tree");
    }
    return BusTap::join(run.bus, live);
}

Result<void> allow_control(std::filesystem::path const& token_file, DaemonRun& run, web::Server::Options& options,
                           Api& api) {
    auto token = web::read_token(token_file);
    if (!token) {
        return std::unexpected{token.error()};
    }
    if (!options.tokens.empty()) {
        options.tokens.push_back(*token); // whoever may control the run may look at it
    }
    api.allow_control(*token, [&run](std::string const& action) { run.status.control(action); });
    return {};
}

web::Handlers handlers_of(Api& api, PushHub& hub, FoxgloveHub& foxglove) {
    web::Handlers handlers;
    handlers.request = [&api](web::Request const& request) {
        auto page = page_of(request);
        return page ? std::move(*page) : api.answer(request);
    };
    handlers.accepts_push = [](std::string const& path, std::vector<std::string> const& offered) {
        auto chosen = FoxgloveHub::choose(offered);
        return chosen || path != "/ws/v1" ? chosen : std::optional{std::string{}};
    };
    handlers.opened = [&hub, &foxglove](web::ClientId client, std::string const&, std::string const& protocol) {
        protocol.empty() ? hub.opened(client) : foxglove.opened(client);
    };
    // A hub that does not know the client does nothing.
    handlers.closed = [&hub, &foxglove](web::ClientId client) {
        hub.closed(client);
        foxglove.closed(client);
    };
    handlers.message = [&hub, &foxglove](web::ClientId client, std::string const& text) {
        hub.message(client, text);
        foxglove.message(client, text);
    };
    return handlers;
}

/// Until the process is asked to end. `tap`: nullptr for a recorded run.
void follow(LiveRun& live, BusTap* tap, EventTail& events, ProcessUses& uses, web::Server& server, PushHub& hub,
            FoxgloveHub& foxglove, Stop& stop) {
    std::uint64_t kept = 0;
    auto measured = std::chrono::steady_clock::now();
    do {
        if (tap != nullptr) {
            tap->follow();
        }
        events.read(live);
        auto const now = std::chrono::steady_clock::now();
        uses.follow(live, now);
        if (tap != nullptr && now - measured >= std::chrono::milliseconds{500}) {
            live.measure(now - measured);
            live.tell_not_heard();
            kept = keep_graph(live, kept);
            measured = now;
        }
        // Nothing that a client has asked for ends the run's monitor, and with it the run.
        web::guarded("telling the clients", [&] { hub.step(server, now); });
        web::guarded("telling the Foxglove clients", [&] { foxglove.step(server); });
    } while (!stop.wait(kPeriod));
}

/// Whoever takes it gets all that there is, for a moment.
void tell_the_rest(PushHub& hub, web::Server& server) {
    auto const begin = std::chrono::steady_clock::now();
    auto const due = begin + std::chrono::seconds{1}; // everything is, once
    auto const all_said = [&] {
        bool all = true;
        web::guarded("the last words", [&] { all = hub.step(server, due); });
        return all;
    };
    while (!all_said() && std::chrono::steady_clock::now() - begin < kLastWords) {
        server.drain(std::chrono::milliseconds{20});
    }
    server.drain(kLastWords);
}

Result<void> serve(MonitorConfig const& config, DaemonRun& run) {
    auto socket = socket_to_serve_on(config);
    if (!socket) {
        return std::unexpected{socket.error()};
    }
    std::string const address = web::address_of(*socket);
    Stop stop;
    run.on_stop([&stop] { stop.ask(); });

    LiveRun live{config.run};
    if (auto ok = read_types(config, live); !ok) {
        return ok;
    }
    bool const is_recorded = !config.recording.empty();
    std::unique_ptr<BusTap> tap;
    std::unique_ptr<RecordedRun> recorded;
    if (is_recorded) {
        recorded = std::make_unique<RecordedRun>(config.recording, live);
    } else {
        auto joined = join(run, live);
        if (!joined) {
            return std::unexpected{joined.error()};
        }
        tap = std::move(*joined);
    }
    web::Server* serving = nullptr;
    Api api{live, [&serving] { return serving == nullptr ? web::ServerCounters{} : serving->counters(); }};
    auto options = options_of(config);
    if (!options) {
        return std::unexpected{options.error()};
    }
    if (!config.control_token.empty() && !is_recorded) {
        if (auto ok = allow_control(config.control_token, run, *options, api); !ok) {
            return ok;
        }
    }
    PushHub hub{live, api};
    FoxgloveHub foxglove{live};
    auto server = web::Server::start(std::move(*socket), *options, handlers_of(api, hub, foxglove));
    if (!server) {
        return std::unexpected{server.error()};
    }
    serving = server->get();
    log::info("{}://{}", options->tls ? "https" : "http", address);

    EventTail events{config.run.events};
    ProcessUses uses{is_recorded ? RunPlan{} : config.run};
    follow(live, tap.get(), events, uses, **server, hub, foxglove, stop);
    run.on_stop({});
    if (!is_recorded) {
        if (!config.run.events.empty()) {
            last_words(live, events);
        }
        tell_the_rest(hub, **server);
    }
    return {};
}

/// The setting that an option of the command line is for; nullptr for other options.
std::filesystem::path* option_file(MonitorConfig& config, std::string_view option) {
    return option == "--token-file" ? &config.token_file
           : option == "--tls-cert" ? &config.tls_cert
           : option == "--tls-key"  ? &config.tls_key
           : option == "--idl"      ? &config.idl
                                    : nullptr;
}

} // namespace
} // namespace gridspace::monitor

int main(int argc, char** argv) {
    using namespace gridspace;
    monitor::MonitorConfig config;
    // `gridspace monitor` passes on what its user says besides the configuration, which is part of the run's folder.
    std::vector<char*> rest{argv, argv + argc};
    for (auto it = rest.begin(); it + 1 < rest.end();) {
        auto* const file = monitor::option_file(config, *it);
        if (file == nullptr) {
            ++it;
            continue;
        }
        *file = *(it + 1);
        it = rest.erase(it, it + 2);
    }
    argc = static_cast<int>(rest.size());
    argv = rest.data();
    program::Declaration const declaration = monitor::monitor_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) { return monitor::serve(config, run); },
                        false,
                        monitor::monitor_declaration};
    return run_daemon(daemon, argc, argv);
}
