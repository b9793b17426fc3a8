// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace gridspace::monitor {

/// Follows the event log of a run while the launcher writes it.
class EventTail {
  public:
    explicit EventTail(std::filesystem::path file) : file_{std::move(file)} {}
    /// Takes what has been added; a line without its end waits for the next call.
    void read(LiveRun& run);

  private:
    std::filesystem::path file_;
    std::ifstream stream_;
    std::string pending_;
};

} // namespace gridspace::monitor
