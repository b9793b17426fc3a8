// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/results.hpp"
#include "launcher/report/tables.hpp"

namespace gridspace::launcher {

/// By how much authentication delays the frames of a run, by process. No rows when no frame was authenticated.
[[nodiscard]] ReportTable authentication_table(Results const& results, config::Node const& scenario);

} // namespace gridspace::launcher
