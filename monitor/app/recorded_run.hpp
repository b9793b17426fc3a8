// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"

#include <atomic>
#include <filesystem>
#include <thread>

namespace gridspace::monitor {

/// A finished run in place of a bus: its recording is read once, on a thread of its own, so that what has been read can
/// be looked at already. The state of the run is "loading", then "recorded".
class RecordedRun {
  public:
    RecordedRun(std::filesystem::path recording, LiveRun& run);
    ~RecordedRun();
    RecordedRun(RecordedRun const&) = delete;
    RecordedRun& operator=(RecordedRun const&) = delete;

  private:
    void load(std::filesystem::path const& recording);

    LiveRun& run_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

} // namespace gridspace::monitor
