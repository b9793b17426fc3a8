// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace gridspace {

/// What this build is, for --version and for the manifest of a run.
struct Version {
    std::string_view version; ///< 0.1.0
    std::string_view commit;  ///< git commit, "-dirty" when the tree was changed, "unknown" outside of git
    std::string_view build_type;
    std::string_view compiler;
};

[[nodiscard]] Version const& version();

/// "gridspace 0.1.0 (1a2b3c4, Release, GNU 12.2.0)"
[[nodiscard]] std::string version_text(std::string_view program);

} // namespace gridspace
