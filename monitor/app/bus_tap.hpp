// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node_config.hpp"
#include "common/result.hpp"
#include "monitor/app/live_run.hpp"

#include <memory>

namespace gridspace::monitor {

/// Listens to all topics of a run's networks and writes none: nobody waits for it, nobody notices it.
class BusTap {
  public:
    [[nodiscard]] static Result<std::unique_ptr<BusTap>> join(bus::NodeConfig const& node, LiveRun& run);
    ~BusTap();
    /// Opens readers for topics that have appeared; from the process's own thread.
    void follow();

  private:
    BusTap() = default;
    struct Network;
    std::vector<std::unique_ptr<Network>> networks_;
};

} // namespace gridspace::monitor
