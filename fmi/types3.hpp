// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// The types that section 2.2.3 of FMI 3.0.1 gives on every platform: void* for instances and states, uint32_t for
/// value references, C's bool.
namespace gridspace::fmi::v3 {

using Instance = void*;
using State = void*;
using Reference = std::uint32_t;
using LogMessage = void(void* environment, int status, char const* category, char const* message);
using IntermediateUpdate = void(void* environment, double time, bool set_requested, bool get_allowed,
                                bool step_finished, bool can_return_early, bool* return_requested, double* return_time);

} // namespace gridspace::fmi::v3
