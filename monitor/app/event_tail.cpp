// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/event_tail.hpp"

#include <nlohmann/json.hpp>

namespace gridspace::monitor {

void EventTail::read(LiveRun& run) {
    if (file_.empty()) {
        return;
    }
    if (!stream_.is_open()) {
        stream_.open(file_);
        if (!stream_.is_open()) {
            return;
        }
    }
    stream_.clear(); // the end of the file was not the end
    char buffer[16384];
    while (stream_.read(buffer, sizeof buffer), stream_.gcount() > 0) {
        pending_.append(buffer, static_cast<std::size_t>(stream_.gcount()));
    }
    for (std::size_t end = 0; (end = pending_.find('\n')) != std::string::npos;) {
        auto const json = nlohmann::json::parse(pending_.substr(0, end), nullptr, false);
        pending_.erase(0, end + 1);
        if (!json.is_object()) {
            continue;
        }
        auto const text = [&](char const* key) {
            return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string{};
        };
        double const time_s = json.contains("time_s") && json["time_s"].is_number() ? json["time_s"].get<double>() : 0;
        std::lock_guard const lock{run.mutex};
        run.add_event({0, time_s, text("source"), text("event"), text("text")});
    }
}

} // namespace gridspace::monitor
