// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/json_value.hpp"
#include "launcher/run/supervisor_core.hpp"

#include <csignal>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unistd.h>

namespace gridspace::launcher {

void Supervisor::read_channel() {
    char buffer[256];
    ssize_t const size = ::read(channel_, buffer, sizeof buffer);
    if (size <= 0 || std::string_view{buffer, static_cast<std::size_t>(size)}.find("stop") != std::string_view::npos) {
        fail_with({ExitCode::interrupted, "stopped", ""});
    }
}

void Supervisor::read_status(WatchedProcess& w) {
    for (std::string const& line : w.read_status()) {
        // A process may say anything: what is nested deeply is left out, before somebody walks through it.
        constexpr int kMostLevels = 8;
        nlohmann::ordered_json status = nlohmann::ordered_json::parse(
            line, [](int level, auto, auto const&) { return level < kMostLevels; }, false);
        if (status.is_object()) {
            on_status(w, status);
        }
    }
}

void Supervisor::on_status(WatchedProcess& w, nlohmann::ordered_json& status) {
    std::string const what = text_of(status, "status");
    if (what == "matched") {
        w.matched = true;
        return;
    }
    if (what == "failed") {
        w.reported = Error{static_cast<ExitCode>(value_of(status, "code", 4)), text_of(status, "message"),
                           text_of(status, "remedy")};
        // The simulator names the culprit of a stall; others notice the consequences.
        if (w.plan.is_simulator && !failure_) {
            fail_with({w.reported->code, fmt::format("{}: {}", w.plan.name, w.reported->message), w.reported->remedy});
        }
    } else if (what == "hold" && w.plan.is_simulator) {
        strike(w, value_of(status, "index", std::size_t{0}));
    } else if (what == "control") {
        control(w, text_of(status, "action"));
    }
    bool const only_the_newest =
        what == "progress" && value_of(status, "time_s", 0.0) < value_of(status, "duration_s", 0.0);
    status["kind"] = "status";
    status["process"] = w.plan.name;
    news_.tell(status, only_the_newest);
}

void Supervisor::control(WatchedProcess const& from, std::string const& action) {
    if (!plan_.allow_control || !from.plan.is_observer) {
        return;
    }
    if (action == "stop") {
        fail_with({ExitCode::interrupted, fmt::format("stopped through {}", from.plan.name), ""});
        return;
    }
    auto const sim = simulator();
    if (plan_.lockstep && sim != watched_.end() && sim->running) {
        std::string const line = action + "\n";
        [[maybe_unused]] auto const written = ::write(sim->child.control_fd, line.data(), line.size());
    }
}

void Supervisor::reap(WatchedProcess& w) {
    if (!plan_.namespaces) {
        ::kill(-w.child.pid, SIGKILL); // what it has started and not waited for: here no namespace ends with it
    }
    auto const end = w.reap();
    if (!end) {
        return;
    }
    read_status(w); // its last words
    // The usual end of a program that somebody else wrote and that runs until it gets SIGTERM.
    bool const did_as_asked = w.asked_to_end && end->signal() == SIGTERM;
    news_.tell(nlohmann::ordered_json{{"kind", "exit"},
                                      {"process", w.plan.name},
                                      {"how", did_as_asked ? "ended when asked" : end->text()},
                                      {"code", did_as_asked ? 0 : end->code()},
                                      {"expected", w.expected_to_die},
                                      {"cpu_s", end->cpu_s}});
    if (!w.expected_to_die && !failure_) {
        judge_end(w, *end);
    }
}

void Supervisor::judge_end(WatchedProcess& w, WatchedProcess::End const& end) {
    // A board turns itself off in any case: what its program said counts.
    bool const clean = end.code() == 0 && !(w.plan.run_on.kind == RunOn::Kind::qemu_system && w.reported);
    if (w.plan.is_simulator) {
        if (clean) {
            simulator_done_ = Clock::now();
        } else {
            fail_with({w.reported ? w.reported->code : ExitCode::child_died,
                       fmt::format("the simulator '{}' ended: {}", w.plan.name, end.text()), "see its log"});
        }
        return;
    }
    if (w.only_looks()) { // it decides nothing: the run goes on without it, and later with it
        w.comes_back = Clock::now() + kPauseOfMonitor;
        return;
    }
    if (clean && !simulator_done_) {
        if (w.plan.is_member &&
            !suspect_) { // it may just be quicker with the last tick than the simulator, who waits for the recorder
            suspect_ = {Clock::now(), w.plan.name};
        }
        if (w.plan.is_guest) { // a host is there until the end, and an emulator does not tell a panic from shutdown
            fail_with({ExitCode::child_died,
                       fmt::format("process '{}', a guest, ended before the run did, with exit code 0", w.plan.name),
                       "see its log: has the machine turned itself off, or has its kernel panicked?"});
        }
        return;
    }
    if (!clean && (!w.plan.is_observer || !simulator_done_)) {
        Error error{ExitCode::child_died, fmt::format("process '{}' died: {}", w.plan.name, end.text()), "see its log"};
        if (w.reported) {
            error = {w.reported->code == ExitCode::interrupted ? ExitCode::child_died : w.reported->code,
                     fmt::format("{}: {}", w.plan.name, w.reported->message), w.reported->remedy};
        }
        fail_with(std::move(error));
    }
}

Error Supervisor::suspicion() const {
    return {ExitCode::child_died,
            fmt::format("process '{}' ended before the run did, with exit code 0", suspect_->second),
            "see its log; a member stays until the last tick"};
}

void Supervisor::fail_with(Error error) {
    if (!failure_) {
        if (error.code == ExitCode::stall && suspect_ && !simulator_done_) { // who has gone does not answer
            error = suspicion();
        } else if (error.code == ExitCode::stall) {
            error = stopped_ones(watched_).value_or(std::move(error));
        }
        news_.tell(nlohmann::ordered_json{{"kind", "failed"},
                                          {"code", static_cast<int>(error.code)},
                                          {"cause", error.message}}); // before the others end of it
        failure_ = std::move(error);
    }
}

} // namespace gridspace::launcher
