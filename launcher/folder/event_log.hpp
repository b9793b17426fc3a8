// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// What happened in a run, one JSON object a line: time_s, source, event, text.
class EventLog {
  public:
    [[nodiscard]] static Result<EventLog> create(std::filesystem::path const& file);
    void write(double time_s, std::string_view source, std::string_view event, std::string_view text);

  private:
    std::ofstream stream_;
};

struct LoggedEvent {
    double time_s{0};
    std::string source, event, text;
};

/// Of frames, datagrams or samples that were none of the run.
[[nodiscard]] bool is_of_strangers(LoggedEvent const& event);

/// Reads the log of a run; damaged lines are left out.
[[nodiscard]] std::vector<LoggedEvent> read_events(std::filesystem::path const& file);

} // namespace gridspace::launcher
