// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace doctor`: what this machine allows, tried rather than guessed.
#include "bus/rtps_guard/known_participants.hpp"
#include "common/realtime.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/doctor_latency.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/kernel_drops.hpp"
#include "launcher/run/namespaces.hpp"
#include "launcher/run/virtual_network.hpp"
#include "launcher/scenario/installation.hpp"
#include "timebox/box.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace gridspace::cli {
namespace {

struct Finding {
    enum class Level { ok, note, problem } level{Level::ok};
    std::string what, detail, remedy;
};
using Level = Finding::Level;

long read_number(char const* file) {
    std::ifstream stream{file};
    long value = -1;
    stream >> value;
    return value;
}

/// Tries, in a child, the namespaces and the network that a run would make.
Finding try_virtual_network() {
    launcher::RunPlan plan;
    plan.hosts = {"a", "b"};
    plan.ports = {{"a", "mgmt0", "mgmt0", "02:47:53:00:00:01", "10.254.0.1", 16},
                  {"b", "mgmt0", "mgmt0", "02:47:53:00:00:02", "10.254.0.2", 16}};
    int report[2];
    if (::pipe2(report, O_CLOEXEC) != 0) {
        return {Level::problem, "virtual network", "no pipe", ""};
    }
    auto const pid = launcher::start_in_namespaces([&] {
        launcher::VirtualNetwork network;
        auto const built = network.build(plan);
        std::string text = built ? "" : describe(built.error());
        if (built) {
            ::setns(network.host("a"), CLONE_NEWNET);
            int const raw = ::socket(AF_PACKET, SOCK_RAW, 0);
            text = raw < 0 ? fmt::format("raw sockets: {}", std::strerror(errno)) : "";
        }
        [[maybe_unused]] auto const written = ::write(report[1], text.data(), text.size());
        return 0;
    });
    ::close(report[1]);
    std::string text;
    char buffer[512];
    for (ssize_t n = 0; pid && (n = ::read(report[0], buffer, sizeof buffer)) > 0;) {
        text.append(buffer, static_cast<std::size_t>(n));
    }
    ::close(report[0]);
    std::string const kind = ::geteuid() == 0 ? "as root: network, mount and PID namespaces"
                                              : "as an ordinary user: user, network, mount and PID namespaces";
    if (!pid) {
        return {Level::problem, "virtual network", pid.error().message,
                pid.error().remedy + "; scenarios without raw frames run on the loopback interface"};
    }
    ::waitpid(*pid, nullptr, 0);
    return text.empty() ? Finding{Level::ok, "virtual network", kind + ", veth, bridges, raw sockets", ""}
                        : Finding{Level::problem, "virtual network", text, "`ip` comes with the package iproute2"};
}

Finding try_real_time() {
    constexpr int kHighest = 49; // that a run uses
    bool const may = may_schedule_fifo(kHighest);
    return {may ? Level::ok : Level::note, "real-time priority", may ? "SCHED_FIFO" : "no SCHED_FIFO",
            may ? ""
                : "real-time runs are measured honestly, but may be late more often; `rtprio` in "
                  "/etc/security/limits.conf"};
}

Finding try_awake_processors() {
    auto const kept = keep_processors_awake();
    return {kept ? Level::ok : Level::note, "idle processors", kept ? "stay awake during a run" : kept.error().message,
            kept ? "" : kept.error().remedy + ", runs are more punctual, and faster"};
}

Finding check_locked_memory() {
    rlimit limit{};
    ::getrlimit(RLIMIT_MEMLOCK, &limit);
    rlimit const wanted{RLIM_INFINITY, RLIM_INFINITY}; // as the supervisor asks for; root may lack the capability
    bool const unlimited = limit.rlim_cur == RLIM_INFINITY || ::setrlimit(RLIMIT_MEMLOCK, &wanted) == 0;
    return {unlimited ? Level::ok : Level::note, "locked memory",
            unlimited ? "unlimited" : fmt::format("{} KiB", limit.rlim_cur / 1024),
            unlimited ? "" : "processes run without mlockall"};
}

Finding check_buffers() {
    long const receive = read_number("/proc/sys/net/core/rmem_max");
    bool const enough = receive >= 2 * 1024 * 1024;
    return {enough ? Level::ok : Level::note, "socket buffers", fmt::format("net.core.rmem_max {} KiB", receive / 1024),
            enough ? "" : "bursts may be dropped: sysctl -w net.core.rmem_max=4194304 net.core.wmem_max=4194304"};
}

Finding check_backlog() {
    std::uint64_t const backlog = launcher::kernel_backlog();
    bool const enough = backlog == 0 || backlog >= launcher::kEnoughBacklog;
    return {enough ? Level::ok : Level::note, "frames in the kernel",
            fmt::format("net.core.netdev_max_backlog {}, {} frames dropped for it since the machine was started",
                        backlog, launcher::kernel_drops()),
            enough ? ""
                   : fmt::format("with more than a hundred hosts frames may be dropped: "
                                 "sysctl -w net.core.netdev_max_backlog={}",
                                 launcher::kEnoughBacklog)};
}

/// Not a matter of the machine, but of what a run may meet on its networks.
Finding check_participants() {
    return {Level::ok, "DDS participants",
            fmt::format("at most {} of others on a bus, with 16384 readers and 16384 writers",
                        rtps_guard::KnownParticipants::kMax),
            ""};
}

Finding check_clock() {
    std::ifstream stream{"/sys/devices/system/clocksource/clocksource0/current_clocksource"};
    std::string source;
    stream >> source;
    bool const good = source == "tsc" || source == "kvm-clock" || source == "arch_sys_counter" ||
                      source == "hyperv_clocksource_tsc_page";
    return {good ? Level::ok : Level::note, "clock source", source.empty() ? "unknown" : source,
            good ? "" : "reading the time may be slow"};
}

Finding check_programs() {
    std::string missing;
    for (char const* program :
         {"gridspace-sim", "gridspace-ev", "gridspace-mcca", "gridspace-recorder", "gridspace-monitor"}) {
        if (!std::filesystem::exists(launcher::program_file(program))) {
            missing += std::string{missing.empty() ? "" : ", "} + program;
        }
    }
    return {missing.empty() ? Level::ok : Level::problem, "programs",
            missing.empty() ? launcher::program_file("").string() : "missing: " + missing,
            missing.empty() ? "" : "build everything: cmake --build --preset release"};
}

Finding check_qos() {
    bool const found = std::filesystem::exists(launcher::qos_file("simulator"));
    return {found ? Level::ok : Level::problem, "QoS profiles", launcher::qos_file("").parent_path().string(),
            found ? "" : "set GRIDSPACE_QOS_DIR"};
}

Finding check_shared_memory() {
    std::size_t count = 0;
    std::error_code error;
    for (auto const& file : std::filesystem::directory_iterator{"/dev/shm", error}) {
        count += file.path().filename().string().starts_with("fast") ? 1 : 0;
    }
    return {Level::ok, "Fast DDS shared memory",
            count == 0 ? "none left behind" : fmt::format("{} files of other programs", count), ""};
}

Finding check_profile_file() {
    bool const stray = std::filesystem::exists("DEFAULT_FASTRTPS_PROFILES.xml");
    return {stray ? Level::note : Level::ok, "stray DDS profiles",
            stray ? "DEFAULT_FASTRTPS_PROFILES.xml in this folder" : "none",
            stray ? "runs ignore it; your own DDS programs do not" : ""};
}

/// `gridspace timebox`, and `time: simulated` of a process.
Finding try_simulated_time() {
    auto const tried = timebox::try_here();
    if (!tried) {
        return {Level::note, "programs in simulated time", tried.error().message, tried.error().remedy};
    }
    bool const good = tried->own_process_numbers && tried->notified;
    return {
        good ? Level::ok : Level::note, "programs in simulated time",
        fmt::format("seccomp, ptrace, pidfd_getfd; {}; {}",
                    tried->notified ? "notifications of calls" : "no notifications of calls",
                    tried->own_process_numbers ? "process numbers of their own" : "process numbers are the machine's"),
        good ? ""
        : tried->own_process_numbers
            ? "calls stop under ptrace, which costs twice as much; Linux 5.19 has notifications that suit"
            : "runs of programs that tell their process number differ; PID or user namespaces would help"};
}

int doctor(bool json) {
    std::vector<Finding> const findings{check_programs(),
                                        check_qos(),
                                        try_virtual_network(),
                                        try_simulated_time(),
                                        try_real_time(),
                                        try_awake_processors(),
                                        check_locked_memory(),
                                        check_buffers(),
                                        check_backlog(),
                                        check_participants(),
                                        check_clock(),
                                        check_shared_memory(),
                                        check_profile_file(),
                                        {std::thread::hardware_concurrency() >= 2 ? Level::ok : Level::note,
                                         "processors", std::to_string(std::thread::hardware_concurrency()), ""}};
    bool problem = false;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (Finding const& f : findings) {
        problem = problem || f.level == Level::problem;
        char const* level = f.level == Level::ok ? "ok" : f.level == Level::note ? "note" : "PROBLEM";
        if (json) {
            list.push_back({{"check", f.what}, {"level", level}, {"detail", f.detail}, {"remedy", f.remedy}});
        } else {
            fmt::print("{:<8} {:<27} {}{}{}\n", level, f.what, f.detail,
                       f.remedy.empty() ? "" : "\n                                     -> ", f.remedy);
        }
    }
    if (json) {
        fmt::print("{}\n", list.dump(2));
    }
    return problem ? static_cast<int>(ExitCode::environment) : 0;
}

} // namespace

void add_doctor(Command app, Action& action) {
    struct Options {
        bool latency{false};
        LatencyQuestion question{5000.0 / 6, 3, false}; // four samples of 4800 Hz: the tick of `protection.yaml`
    };
    auto const options = std::make_shared<Options>();
    Command verb = app.add_subcommand("doctor", "look at what this machine allows, and what helps");
    verb.add_flag("--latency", options->latency, "measure how late it wakes a process up, for each way to wait");
    verb.add_option("--period-us", options->question.period_us,
                    "between two wake-ups (default: 833.3, a tick of case 2)")
        .check(in_range(50.0, 1e6));
    verb.add_option("--seconds", options->question.seconds, "for each way to wait (default: 3)")
        .check(in_range(0.1, 3600.0));
    verb.add_flag("--json", options->question.json, "as JSON");
    verb.callback([options, &action] {
        action = [options] {
            return options->latency ? show_latency(options->question) : doctor(options->question.json);
        };
    });
}

} // namespace gridspace::cli
