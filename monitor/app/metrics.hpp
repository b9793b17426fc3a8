// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"
#include "monitor/web/server.hpp"

#include <string>

namespace gridspace::monitor {

/// The run as Prometheus reads it (text format 0.0.4).
[[nodiscard]] std::string metrics_text(LiveRun const& run, web::ServerCounters const& server);

} // namespace gridspace::monitor
