// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/live_verdict.hpp"

#include "common/time.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/judge/live_judge.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kBetweenLooks{1000};
constexpr double kRestPerLook = 19; ///< times as long as a look worked: of 20 parts one is work

JudgedRun judged_run(Scenario const& scenario, std::filesystem::path const& folder) {
    config::Diagnostics reported; // when the scenario was checked
    config::Node const* timeline = scenario.resolved.find("events");
    return {folder,
            read_expectations(scenario.expect, reported),
            timeline == nullptr ? config::Node{} : *timeline,
            scenario.simulation.duration().to_double(),
            parse_utc(scenario.simulation.epoch).value_or(0),
            scenario.clock.mode == bus::ClockMode::lockstep};
}

std::string to_json(LiveJudge::Look const& look) {
    Json expectations = Json::array();
    for (ExpectationStanding const& s : look.standings) {
        expectations.push_back({{"name", s.result.name},
                                {"standing", name_of(s.standing)},
                                {"value", s.result.value ? Json(*s.result.value) : Json(nullptr)},
                                {"unit", s.result.unit},
                                {"detail", s.result.detail}});
    }
    return Json{{"reached_s", look.reached_s}, {"expectations", std::move(expectations)}}.dump(
        -1, ' ', false, Json::error_handler_t::replace);
}

[[noreturn]] void judge_on(JudgedRun run, std::filesystem::path const& file) {
    LiveJudge judge{std::move(run)};
    while (true) {
        std::clock_t const before = std::clock(); // of work: during a run in real time it waits long for the processor
        if (auto const look = judge.look()) {
            (void)replace_file(file, to_json(*look)); // on a full disk there is none, and the run says so itself
        }
        std::chrono::duration<double> const worked{static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC};
        std::this_thread::sleep_for(std::max<std::chrono::duration<double>>(kBetweenLooks, kRestPerLook * worked));
    }
}

} // namespace

LiveVerdict::LiveVerdict(Scenario const& scenario, std::filesystem::path const& folder)
    : file_{folder / "so_far.json"} {
    bool const is_watched = std::any_of(scenario.processes.begin(), scenario.processes.end(),
                                        [](Process const& p) { return p.program.name == "gridspace-monitor"; });
    JudgedRun run = judged_run(scenario, folder);
    if (!is_watched || run.expectations.empty()) {
        return;
    }
    pid_t const launcher = ::getpid();
    pid_ = ::fork();
    if (pid_ != 0) {
        return; // where none can be had, the expectations are judged when the run has ended
    }
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != launcher) {
        ::_exit(0);
    }
    ::prctl(PR_SET_NAME, "gridspace-judge");
    ::setpriority(PRIO_PROCESS, 0, 19);
    for (int const number : {SIGINT, SIGTERM, SIGHUP}) { // of a terminal; the launcher ends this
        std::signal(number, SIG_IGN);
    }
    ::close_range(STDERR_FILENO + 1, ~0U, 0); // locks and sockets are the launcher's
    try {
        judge_on(std::move(run), file_);
    } catch (std::exception const&) {
        ::_exit(1);
    }
}

LiveVerdict::~LiveVerdict() {
    if (pid_ <= 0) {
        return;
    }
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
    std::filesystem::remove(file_.string() + ".new", ignored);
}

} // namespace gridspace::launcher
