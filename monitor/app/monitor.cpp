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
#include "monitor/app/pages.hpp"
#include "monitor/app/push.hpp"
#include "monitor/app/run_plan.hpp"
#include "monitor/web/server.hpp"

#include <condition_variable>
#include <fmt/format.h>
#include <sys/socket.h>

namespace gridspace::monitor {
namespace {

constexpr int kHandedSocket = 4; ///< where `gridspace run` puts a listening socket
constexpr std::chrono::milliseconds kPeriod{50};

/// The socket that the launcher opened outside of the run's namespaces, or an own one.
Result<UniqueFd> socket_to_serve_on(MonitorConfig const& config) {
    int listening = 0;
    socklen_t size = sizeof listening;
    if (::getsockopt(kHandedSocket, SOL_SOCKET, SO_ACCEPTCONN, &listening, &size) == 0 && listening != 0) {
        return UniqueFd{kHandedSocket};
    }
    return web::listen_at(config.listen);
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

Result<void> serve(MonitorConfig const& config, DaemonRun& run) {
    auto socket = socket_to_serve_on(config);
    if (!socket) {
        return std::unexpected{socket.error()};
    }
    std::string const address = web::address_of(*socket);
    Stop stop;
    run.on_stop([&stop] { stop.ask(); });

    LiveRun live{config.run};
    auto tap = BusTap::join(run.bus, live);
    if (!tap) {
        return std::unexpected{tap.error()};
    }
    web::Server* serving = nullptr;
    Api const api{live, [&serving] { return serving == nullptr ? web::ServerCounters{} : serving->counters(); }};
    web::Server::Options options;
    for (config::Ref const& host : config.allow_hosts) {
        options.sites.hosts.push_back(host.name);
    }
    web::Handlers handlers;
    handlers.request = [&api](web::Request const& request) {
        auto page = page_of(request);
        return page ? std::move(*page) : api.answer(request);
    };
    PushHub hub{live, api};
    handlers.accepts_push = [](std::string const& path) { return path == "/ws/v1"; };
    handlers.opened = [&hub](web::ClientId client, std::string const&) { hub.opened(client); };
    handlers.closed = [&hub](web::ClientId client) { hub.closed(client); };
    handlers.message = [&hub](web::ClientId client, std::string const& text) { hub.message(client, text); };
    auto server = web::Server::start(std::move(*socket), options, std::move(handlers));
    if (!server) {
        return std::unexpected{server.error()};
    }
    serving = server->get();
    log::info("http://{}", address);

    EventTail events{config.run.events};
    auto measured = std::chrono::steady_clock::now();
    do {
        (*tap)->follow();
        events.read(live);
        auto const now = std::chrono::steady_clock::now();
        if (now - measured >= std::chrono::milliseconds{500}) {
            live.measure(now - measured);
            measured = now;
        }
        hub.step(**server, now);
    } while (!stop.wait(kPeriod));
    run.on_stop({});
    return {};
}

} // namespace
} // namespace gridspace::monitor

int main(int argc, char** argv) {
    using namespace gridspace;
    monitor::MonitorConfig config;
    Daemon const daemon{"gridspace-monitor",
                        "shows a run in a browser, and to programs over REST",
                        [&](config::Fields& f) { describe(f, config); },
                        {},
                        [&](DaemonRun& run) { return monitor::serve(config, run); }};
    return run_daemon(daemon, argc, argv);
}
