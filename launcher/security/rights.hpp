// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"
#include "launcher/security/documents.hpp"

namespace gridspace::launcher {

/// What a process may do on a secured bus, by what it declares: publish what it writes, subscribe to what it reads, and
/// what the framework needs of it. Everybody may read the framework's own topics (bus/topics.hpp); who only looks on
/// may read all, and publishes nothing.
[[nodiscard]] Rights rights_of(Scenario const& scenario, Process const& process);

} // namespace gridspace::launcher
