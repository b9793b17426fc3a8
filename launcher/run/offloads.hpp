// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>

namespace gridspace::launcher {

/// Makes the kernel finish every frame before it leaves `interface` of the network namespace `netns`: checksums
/// written, nothing longer than the MTU. Whoever hands on frames by raw sockets (a process in a cable that carries IP)
/// would otherwise hand on unfinished ones, which the receiver drops.
[[nodiscard]] Result<void> finish_frames_before_sending(int netns, std::string const& interface);

} // namespace gridspace::launcher
