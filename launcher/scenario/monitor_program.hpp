// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/program.hpp"

#include <memory>

namespace gridspace::launcher {

/// gridspace-monitor: what the launcher has to know about it.
[[nodiscard]] std::unique_ptr<ProcessSettings> read_monitor(config::Fields& f);

} // namespace gridspace::launcher
