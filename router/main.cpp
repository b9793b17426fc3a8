// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-router: carries an allow-list of topics between DDS domains and sites.
#include "common/command_line/command.hpp"
#include "common/config/merge.hpp"
#include "common/log.hpp"
#include "common/unique_fd.hpp"
#include "common/version.hpp"
#include "router/router.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

namespace gridspace::router {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds kAnswerPatience{10}; ///< from the start until somebody is told of a link that is silent

struct Options {
    std::filesystem::path config, qos;
    bool check{false}, json{false};
};

/// Events as log lines, or as JSON lines on standard output.
class Printer final : public Reporter {
  public:
    explicit Printer(bool json) : json_{json} {}

    void ready() {
        print({{"event", "ready"}});
        log::info("ready");
    }
    void site(std::string const& end, std::string const& name, bool here, bool clean) override {
        print({{"event", here ? "connected" : clean ? "left" : "lost"}, {"end", end}, {"site", name}});
        if (here) {
            log::info("{}: '{}' is connected", end, name);
        } else if (clean) {
            log::info("{}: '{}' has left", end, name);
        } else {
            log::warning("{}: '{}' is lost: nothing was heard of it for 10 s; it is taken up again when it comes back",
                         end, name);
        }
    }
    void carries(Route const& route, RouterConfig const& config, bool now) override {
        std::vector<std::string> to;
        std::string shown;
        for (std::size_t const end : route.to) {
            to.push_back(config.ends[end].name.name);
            shown += (shown.empty() ? "" : ", ") + to.back();
        }
        std::string const& from = config.ends[route.from].name.name;
        bool const kept = route.qos.durability != bus::Durability::volatile_;
        print({{"event", now ? "carries" : "stops"},
               {"topic", route.topic},
               {"type", route.type},
               {"from", from},
               {"to", to},
               {"reliable", route.qos.reliable},
               {"kept", kept}});
        if (now) {
            log::info("carries '{}' ({}{}{}) from {} to {}", route.topic, route.type,
                      route.qos.reliable ? ", reliable" : ", best effort", kept ? ", kept for late joiners" : "", from,
                      shown);
        } else {
            log::info("carries '{}' from {} no more: nobody writes it there, or its QoS have changed", route.topic,
                      from);
        }
    }
    void note(std::string const& text) override {
        print({{"event", "note"}, {"text", text}});
        log::warning("{}", text);
    }
    void total(std::string const& topic, std::string const& from, std::string const& to, std::uint64_t samples,
               std::uint64_t octets, std::uint64_t refused, std::uint64_t dropped) override {
        print({{"event", "total"},
               {"topic", topic},
               {"from", from},
               {"to", to},
               {"samples", samples},
               {"octets", octets},
               {"refused", refused},
               {"dropped", dropped}});
        log::info("{} from {} to {}: {} samples, {} octets{}{}", topic, from, to, samples, octets,
                  refused > 0 ? fmt::format(", {} refused", refused) : "",
                  dropped > 0 ? fmt::format(", {} dropped", dropped) : "");
    }

  private:
    void print(Json const& json) const {
        if (json_) {
            fmt::print("{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
            std::fflush(stdout);
        }
    }
    bool json_;
};

std::optional<int> parse(int argc, char** argv, Options& options) {
    command_line::Program program{std::string{kProgram}, "carries topics between DDS domains and sites",
                                  version_text(kProgram)};
    command_line::Command app = program.command();
    app.add_option("--config", options.config, "its configuration (YAML)").required();
    app.add_option("--qos", options.qos, "QoS profiles of its endpoints (router.xml)").required();
    app.add_flag("--check", options.check, "check the configuration and end");
    app.add_flag("--json", options.json, "what happens, as JSON lines on standard output");
    std::string level{"info"};
    app.add_option("--log-level", level, "debug, info, warning or error")
        .check(command_line::one_of({"debug", "info", "warning", "error"}));
    if (std::optional<int> const code = program.parse(argc, argv)) {
        return code;
    }
    using log::Level;
    log::set_level(level == "debug"     ? Level::debug
                   : level == "warning" ? Level::warning
                   : level == "error"   ? Level::error
                                        : Level::info);
    return std::nullopt;
}

bool read(std::filesystem::path const& file, RouterConfig& config) {
    config::Diagnostics diagnostics;
    if (auto const root = config::load_extended(file, diagnostics)) {
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, config); });
    }
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        fmt::print(stderr, "{}\n", diagnostics.render());
    }
    return diagnostics.ok();
}

void serve_until_signal(Router& router, UniqueFd const& signals, UniqueFd const& changes) {
    using Clock = std::chrono::steady_clock;
    auto const answer_due = Clock::now() + kAnswerPatience;
    bool asked = false;
    while (true) {
        router.update();
        auto const left = std::chrono::ceil<std::chrono::milliseconds>(answer_due - Clock::now()).count();
        if (!asked && left <= 0) {
            router.note_silent_links();
            asked = true;
        }
        pollfd ready[2]{{signals.get(), POLLIN, 0}, {changes.get(), POLLIN, 0}};
        if (::poll(ready, 2, asked ? -1 : static_cast<int>(left)) < 0 && errno != EINTR) {
            break;
        }
        if (ready[0].revents != 0) {
            break;
        }
        std::uint64_t count = 0;
        [[maybe_unused]] auto const taken = ::read(changes.get(), &count, sizeof count);
    }
}

int main_function(int argc, char** argv) {
    sigset_t stop;
    sigemptyset(&stop);
    sigaddset(&stop, SIGINT);
    sigaddset(&stop, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &stop, nullptr); // before any thread: all inherit it
    std::signal(SIGPIPE, SIG_IGN);
    UniqueFd const signals{::signalfd(-1, &stop, SFD_CLOEXEC)};
    UniqueFd const changes{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};

    Options options;
    if (auto const code = parse(argc, argv, options)) {
        return *code;
    }
    RouterConfig config;
    if (!read(options.config, config)) {
        return static_cast<int>(ExitCode::usage);
    }
    if (options.check) {
        fmt::print("{}: valid\n", options.config.string());
        return 0;
    }
    if (auto ok = take_run_networks(config, [](char const* name) { return std::getenv(name); }); !ok) {
        log::error("{}", describe(ok.error()));
        return static_cast<int>(ok.error().code);
    }
    Printer printer{options.json};
    Router router{config, printer};
    auto const opened = router.open(options.qos, [&changes] {
        std::uint64_t const one = 1;
        [[maybe_unused]] auto const written = ::write(changes.get(), &one, sizeof one);
    });
    if (!opened) {
        log::error("{}", describe(opened.error()));
        return static_cast<int>(opened.error().code);
    }
    printer.ready();
    serve_until_signal(router, signals, changes);
    signalfd_siginfo first;
    [[maybe_unused]] auto const taken = ::read(signals.get(), &first, sizeof first);
    pthread_sigmask(SIG_UNBLOCK, &stop, nullptr); // a second one ends it at once
    router.close();
    return 0;
}

} // namespace
} // namespace gridspace::router

int main(int argc, char** argv) {
    int const code = gridspace::router::main_function(argc, argv);
    // A participant with TLS over TCP connects to itself, and Fast DDS 2.9.1 leaves the thread of that connection
    // behind. While the library takes its own globals down, that thread has broken the heap, in one of five ends of a
    // program.
    std::fflush(nullptr);
    std::_Exit(code);
}
