// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/process_use.hpp"

#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace gridspace::monitor {
namespace {

constexpr std::chrono::seconds kPeriod{1};

pid_t read_pid(std::filesystem::path const& file) {
    std::ifstream stream{file};
    pid_t pid = 0;
    return stream >> pid && pid > 0 ? pid : 0;
}

/// In a container /proc may be that of other process identifiers than ours: then it speaks of strangers.
bool proc_is_ours() {
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self", error) == std::to_string(::getpid());
}

} // namespace

std::optional<double> processor_s_of(pid_t pid) {
    clockid_t clock{};
    timespec used{};
    if (::clock_getcpuclockid(pid, &clock) != 0 || ::clock_gettime(clock, &used) != 0) {
        return std::nullopt;
    }
    return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

std::optional<std::uint64_t> memory_of(pid_t pid) {
    static bool const ours = proc_is_ours();
    std::ifstream stream{fmt::format("/proc/{}/statm", pid)};
    std::uint64_t size = 0, resident = 0;
    if (!ours || !(stream >> size >> resident)) {
        return std::nullopt;
    }
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

ProcessUses::ProcessUses(RunPlan const& plan) {
    for (RunPlan::Process const& process : plan.processes) {
        if (!process.pid_file.empty()) {
            followed_.push_back({process.name, process.pid_file, 0, 0, {}});
        }
    }
}

std::optional<ProcessUse> ProcessUses::look(Followed& process, std::chrono::steady_clock::time_point now) {
    pid_t const pid = read_pid(process.pid_file);
    auto const used_s = pid > 0 ? processor_s_of(pid) : std::nullopt;
    if (!used_s) {
        process.pid = 0;
        return std::nullopt;
    }
    ProcessUse out{*used_s, std::nullopt, memory_of(pid)};
    if (pid == process.pid) { // a new incarnation begins anew
        std::chrono::duration<double> const passed = now - process.at;
        out.cpu_percent = 100 * (*used_s - process.cpu_s) / passed.count();
    }
    process.pid = pid;
    process.cpu_s = *used_s;
    process.at = now;
    return out;
}

void ProcessUses::follow(LiveRun& live, std::chrono::steady_clock::time_point now) {
    if (followed_.empty() || now < next_) {
        return;
    }
    next_ = now + kPeriod;
    std::map<std::string, ProcessUse> found;
    for (Followed& process : followed_) {
        if (auto const use = look(process, now)) {
            found.emplace(process.name, *use);
        }
    }
    std::lock_guard const lock{live.mutex};
    live.use = std::move(found);
}

} // namespace gridspace::monitor
