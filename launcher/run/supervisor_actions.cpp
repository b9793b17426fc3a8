// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/supervisor_core.hpp"

#include <algorithm>
#include <csignal>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace gridspace::launcher {

void Supervisor::strike(WatchedProcess& simulator, std::size_t index) {
    std::string answer;
    if (index < plan_.holds.size()) {
        for (ProcessAction const& action : plan_.holds[index]) {
            if (!act(action, answer)) {
                return;
            }
        }
    }
    answer += "go\n";
    [[maybe_unused]] auto const written = ::write(simulator.child.control_fd, answer.data(), answer.size());
}

bool Supervisor::act(ProcessAction const& action, std::string& answer) {
    using Kind = ProcessAction::Kind;
    auto const w = std::find_if(watched_.begin(), watched_.end(),
                                [&](WatchedProcess const& x) { return x.plan.name == action.process; });
    char const* text = "killed";
    switch (action.kind) {
    case Kind::kill:
        w->expected_to_die = true;
        kill_and_reap(*w);
        answer += "drop " + action.process + "\n";
        break;
    case Kind::pause:
        // In lockstep it gets no ticks. A stopped process would lose samples, depending on the machine.
        if (!plan_.lockstep) {
            ::kill(-w->child.pid, SIGSTOP);
        }
        w->paused = true;
        answer += "drop " + action.process + "\n";
        text = "paused";
        break;
    case Kind::resume:
        ::kill(-w->child.pid, SIGCONT);
        w->paused = false;
        answer += "rejoin " + action.process + "\n";
        text = "resumed";
        break;
    case Kind::restart:
        w->expected_to_die = true;
        w->paused = false;
        kill_and_reap(*w);
        if (!restart(*w, action.at_s)) {
            return false;
        }
        answer += fmt::format("restarted {} {}\n", action.process, w->incarnation);
        text = "restarted";
        break;
    }
    news_.tell(nlohmann::ordered_json{{"kind", "process_action"},
                                      {"event", action.event},
                                      {"process", action.process},
                                      {"what", text},
                                      {"time_s", action.at_s}});
    return true;
}

void Supervisor::kill_and_reap(WatchedProcess& w) {
    if (w.running) {
        ::kill(-w.child.pid, SIGKILL);
        reap(w);
    }
}

bool Supervisor::restart(WatchedProcess& w, double at_s) {
    std::vector<std::string> absent;
    for (WatchedProcess const& other : watched_) {
        if (!other.running && &other != &w && !other.is_external()) {
            absent.push_back(other.plan.name);
        }
    }
    w.next_incarnation(at_s, absent);
    if (auto ok = start(w); !ok) {
        fail_with(ok.error());
        return false;
    }
    w.expected_to_die = false;
    return true;
}

} // namespace gridspace::launcher
