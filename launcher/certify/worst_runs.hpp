// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/certify/certificate.hpp"
#include "launcher/run/interrupt_watch.hpp"

namespace gridspace::launcher {

/// Does the worst runs again whose folders are gone, `jobs` at a time, and keeps them: recording, report, frames and
/// COMTRADE. In lockstep alone: there a run gives the same again. An interrupt leaves the rest as it is.
[[nodiscard]] Result<void> keep_worst(std::vector<GroupResult>& groups, Certificate const& certificate,
                                      std::size_t jobs, InterruptWatch& interrupts);

} // namespace gridspace::launcher
