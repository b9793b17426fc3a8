// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::cli {

/// A verb and its options, for shells.
struct VerbOptions {
    std::string verb, description;
    std::vector<std::string> options;
};

/// A completion script for bash, zsh or fish; empty for another shell.
[[nodiscard]] std::string completion_script(std::string_view shell, std::vector<VerbOptions> const& verbs);

} // namespace gridspace::cli
