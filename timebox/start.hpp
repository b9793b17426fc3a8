// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>
#include <sys/types.h>
#include <vector>

namespace gridspace::timebox {

/// The program stands before its first instruction, traced, with the filter of held_calls() and without address space
/// randomisation; its exec is still to be prepared.
/// `detached`: it has nothing of this process but standard output and error, and is in a process group of its own.
[[nodiscard]] Result<pid_t> start_traced(std::vector<std::string> const& command, bool detached);

} // namespace gridspace::timebox
