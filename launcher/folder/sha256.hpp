// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gridspace::launcher {

/// SHA-256 of a file as hex; empty when it cannot be read.
[[nodiscard]] std::string sha256_of(std::filesystem::path const& file);
[[nodiscard]] std::string sha256_of_text(std::string_view text);

} // namespace gridspace::launcher
