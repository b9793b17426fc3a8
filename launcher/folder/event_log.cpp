// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/folder/event_log.hpp"

#include "common/json_value.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {

using Json = nlohmann::ordered_json;

Result<EventLog> EventLog::create(std::filesystem::path const& file) {
    EventLog log;
    log.stream_.open(file, std::ios::trunc);
    return log.stream_ ? Result<EventLog>{std::move(log)}
                       : fail(ExitCode::environment, fmt::format("cannot write '{}'", file.string()));
}

void EventLog::write(double time_s, std::string_view source, std::string_view event, std::string_view text) {
    stream_ << Json{{"time_s", time_s}, {"source", source}, {"event", event}, {"text", text}}.dump(
                   -1, ' ', false, Json::error_handler_t::replace)
            << std::endl; // each line is there when somebody looks, or when everything is killed
}

bool is_of_strangers(LoggedEvent const& event) {
    return event.event == "foreign_frames" || event.event == "foreign_datagrams" || event.event == "impostor" ||
           event.event == "unauthenticated_participant";
}

std::vector<LoggedEvent> read_events(std::filesystem::path const& file) {
    std::vector<LoggedEvent> out;
    std::ifstream stream{file};
    for (std::string line; std::getline(stream, line);) {
        Json const json = Json::parse(line, nullptr, false);
        if (json.is_object()) {
            std::string const none;
            out.push_back({value_of(json, "time_s", 0.0), value_of(json, "source", none), value_of(json, "event", none),
                           value_of(json, "text", none)});
        }
    }
    return out;
}

} // namespace gridspace::launcher
