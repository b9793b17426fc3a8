// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace gridspace::monitor {

/// A file that is in the program.
struct Asset {
    std::string_view path; ///< "/app.js"
    std::string_view content_type, etag;
    std::string_view plain, gzip;
};
[[nodiscard]] std::span<Asset const> assets();

} // namespace gridspace::monitor
