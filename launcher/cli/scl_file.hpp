// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/scl/scl_import.hpp"

#include <filesystem>

namespace gridspace::cli {

/// The text of an SCL file.
[[nodiscard]] Result<std::string> read_whole_scl_file(std::filesystem::path const& file);

/// The streams of an SCL file; what was left out or assumed is printed as notes.
[[nodiscard]] Result<scl::Import> read_scl_file(std::filesystem::path const& file, scl::ImportOptions const& options);

} // namespace gridspace::cli
