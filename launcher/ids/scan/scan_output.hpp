// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/scan/capture_scan.hpp"

#include <string>

namespace gridspace::scan {

/// For a terminal.
[[nodiscard]] std::string to_text(CaptureScan const& scan, std::filesystem::path const& file);
[[nodiscard]] std::string to_json(CaptureScan const& scan, std::filesystem::path const& file);
/// One page that opens offline.
[[nodiscard]] std::string to_page(CaptureScan const& scan, std::filesystem::path const& file);

/// What a rule means, in one line.
[[nodiscard]] std::string meaning_of(std::string const& rule, bool goose);

} // namespace gridspace::scan
