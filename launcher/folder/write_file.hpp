// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string_view>

namespace gridspace::launcher {

/// Writes a whole file; fails with its name and the reason of the system.
[[nodiscard]] Result<void> write_file(std::filesystem::path const& file, std::string_view text);

/// Puts a file with this text in the place of whatever had its name, in one step: nobody sees half of it, a full disk
/// leaves what was there before, and a link of that name is replaced, never followed.
[[nodiscard]] Result<void> replace_file(std::filesystem::path const& file, std::string_view text);

/// Whether write_file() may succeed, asked before a long run whose result it is for: leaves no file behind and changes
/// none. Pipes and devices are not opened.
[[nodiscard]] Result<void> check_writable(std::filesystem::path const& file);

} // namespace gridspace::launcher
