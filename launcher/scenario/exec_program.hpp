// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/program.hpp"

namespace gridspace::launcher {

/// `program: exec`, somebody's own.
[[nodiscard]] std::unique_ptr<ProcessSettings> read_exec(config::Fields& f);

} // namespace gridspace::launcher
