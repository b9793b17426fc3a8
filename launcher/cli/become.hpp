// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::cli {

/// Puts another program of Gridspace, with its role's QoS profiles, into the place of this process. Returns only when
/// that fails: the exit code, the mistake printed.
[[nodiscard]] int become(std::string_view program, std::string_view qos_role, std::vector<std::string> arguments);

/// A stray Fast DDS profile file, such as one in the folder where this was called, must not change what a program does.
void leave_profiles_aside();

} // namespace gridspace::cli
