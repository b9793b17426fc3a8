// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <functional>
#include <sys/types.h>

namespace gridspace::launcher {

/// Runs `body` as process 1 of new network, mount and PID namespaces; as an ordinary user in a new user namespace too,
/// in which it is root. Everything in them ends with it. Its return value is its exit code. Fails, without starting it,
/// where the kernel does not allow that.
[[nodiscard]] Result<pid_t> start_in_namespaces(std::function<int()> const& body);

/// Runs `body` as a plain child process that adopts its orphans.
[[nodiscard]] Result<pid_t> start_without_namespaces(std::function<int()> const& body);

} // namespace gridspace::launcher
