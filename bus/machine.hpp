// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gridspace::bus {

/// Names the machine for as long as it runs: what has the same name has the same clocks, in containers and emulated
/// processes too; a guest of a hypervisor has its own. Empty when the kernel does not say.
[[nodiscard]] std::string const& this_machine();

} // namespace gridspace::bus
