// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <istream>
#include <optional>

namespace gridspace::launcher {

/// Frames that this machine's kernel has dropped, on all of its networks since it was started, because more waited at a
/// processor than net.core.netdev_max_backlog lets. `softnet_stat`: the file in /proc/net, a line of hexadecimal
/// numbers for each processor. 0 where it says nothing.
[[nodiscard]] std::uint64_t kernel_drops(std::istream& softnet_stat);
[[nodiscard]] std::uint64_t kernel_drops();

/// A switch with 200 hosts hands each frame to all of them at once, and programs send several.
constexpr std::uint64_t kEnoughBacklog = 20000;

/// How many may wait; 0: not known.
[[nodiscard]] std::uint64_t kernel_backlog();

/// What to say of drops during a run, and what to do; nothing when there were none. A virtual cable that fills its
/// receiver's queue is of any run or container of this machine: what is dropped may be of another one.
[[nodiscard]] std::optional<Error> lost_in_kernel(std::uint64_t dropped, std::uint64_t backlog);

} // namespace gridspace::launcher
