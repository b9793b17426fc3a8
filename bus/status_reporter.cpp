// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/status_reporter.hpp"

#include "common/lateness_json.hpp"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <unistd.h>

namespace gridspace {
namespace {

using Json = nlohmann::ordered_json;

} // namespace

StatusReporter::~StatusReporter() {
    output_.drain(std::chrono::seconds{2}); // who started the process is about to end it
}

void StatusReporter::send(std::string line, bool only_the_newest) {
    line += '\n';
    std::lock_guard const lock{mutex_};
    if (only_the_newest) {
        output_.put_latest(std::move(line));
    } else {
        output_.put(line);
    }
}

void StatusReporter::go_on() {
    std::lock_guard const lock{mutex_};
    output_.flush();
}

void StatusReporter::matched() {
    send(Json{{"status", "matched"}}.dump());
}

// `at_ns`: the instant on the machine's steady clock. Who reads this may be late, and the speed of a run is computed of
// it.
void StatusReporter::ready() {
    send(Json{{"status", "ready"}, {"at_ns", std::chrono::steady_clock::now().time_since_epoch().count()}}.dump());
}

void StatusReporter::failed(Error const& error) {
    send(Json{{"status", "failed"},
              {"code", static_cast<int>(error.code)},
              {"message", error.message},
              {"remedy", error.remedy}}
             .dump(-1, ' ', false, Json::error_handler_t::replace));
}

void StatusReporter::progress(double time_s, double duration_s, std::uint64_t overruns, bool now) {
    auto const instant = std::chrono::steady_clock::now();
    if (fd_ < 0 || (!now && instant - last_progress_ < std::chrono::milliseconds{100})) {
        return;
    }
    last_progress_ = instant;
    send(Json{{"status", "progress"},
              {"time_s", time_s},
              {"duration_s", duration_s},
              {"overruns", overruns},
              {"at_ns", instant.time_since_epoch().count()}}
             .dump(),
         !now);
}

void StatusReporter::lateness(Lateness::Summary const& ticks) {
    nlohmann::ordered_json line{{"status", "lateness"}};
    line.update(to_json(ticks));
    send(line.dump());
}

void StatusReporter::event(double time_s, std::string_view source, std::string_view kind, std::string_view text) {
    send(Json{{"status", "event"}, {"time_s", time_s}, {"source", source}, {"event", kind}, {"text", text}}.dump(
        -1, ' ', false, Json::error_handler_t::replace));
}

Result<std::vector<std::string>> StatusReporter::hold(std::uint64_t index, bool wait) {
    std::vector<std::string> answers;
    if (fd_ < 0) {
        return answers;
    }
    send(Json{{"status", "hold"}, {"index", index}}.dump());
    while (wait && !input_ended_) {
        go_on();
        auto line = read_line(std::chrono::seconds{1});
        if (!line) {
            continue;
        }
        if (*line == "go") {
            return answers;
        }
        if (*line == "pause" || *line == "continue" || line->starts_with("step ")) {
            take_pause(*line);
        } else {
            answers.push_back(std::move(*line));
        }
    }
    return wait ? fail(ExitCode::child_died, "the launcher did not let the run go on after a held tick")
                : Result<std::vector<std::string>>{std::move(answers)};
}

std::optional<std::string> StatusReporter::read_line(std::chrono::milliseconds patience) {
    std::size_t end = input_.find('\n');
    if (end == std::string::npos) {
        pollfd ready{STDIN_FILENO, POLLIN, 0};
        if (input_ended_ || ::poll(&ready, 1, static_cast<int>(patience.count())) <= 0) {
            return std::nullopt;
        }
        char buffer[512];
        ssize_t const size = ::read(STDIN_FILENO, buffer, sizeof buffer);
        input_ended_ = size <= 0;
        input_.append(buffer, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
        end = input_.find('\n');
    }
    if (end == std::string::npos) {
        return std::nullopt;
    }
    std::string line = input_.substr(0, end);
    input_.erase(0, end + 1);
    return line;
}

void StatusReporter::take_pause(std::string const& line) {
    paused_ = line == "pause";
    steps_left_ = line.starts_with("step ") ? std::strtoull(line.c_str() + 5, nullptr, 10) : 0;
}

std::chrono::steady_clock::duration StatusReporter::pause_if_asked(double time_s, std::atomic<bool> const& stop) {
    if (fd_ < 0 || input_ended_) {
        return {};
    }
    while (auto line = read_line(std::chrono::milliseconds{0})) {
        take_pause(*line);
    }
    if (steps_left_ > 0 && --steps_left_ == 0) {
        paused_ = true;
    }
    if (!paused_) {
        return {};
    }
    auto const begin = std::chrono::steady_clock::now();
    send(Json{{"status", "paused"}, {"time_s", time_s}}.dump());
    while (paused_ && !stop && !input_ended_) {
        go_on();
        if (auto line = read_line(std::chrono::milliseconds{100})) {
            take_pause(*line);
        }
    }
    paused_ = false;
    send(Json{{"status", "resumed"}, {"time_s", time_s}}.dump());
    return std::chrono::steady_clock::now() - begin;
}

void StatusReporter::control(std::string_view action) {
    send(Json{{"status", "control"}, {"action", action}}.dump());
}

} // namespace gridspace
