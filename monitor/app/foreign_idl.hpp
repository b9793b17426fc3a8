// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace gridspace::monitor {

/// IDL text by type name, for the types of an IDL file: those of foreign devices, which nobody publishes on
/// type_catalog. The file holds everything that it needs (no #include). An error names file and line.
[[nodiscard]] Result<std::map<std::string, std::string>> read_foreign_idl(std::filesystem::path const& file);

} // namespace gridspace::monitor
