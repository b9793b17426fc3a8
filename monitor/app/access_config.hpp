// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::monitor {

/// Where the dashboard is reached, and by whom; and what it cannot know by itself.
struct AccessConfig {
    std::string listen{"127.0.0.1:0"};    ///< when no socket is handed over
    std::vector<config::Ref> allow_hosts; ///< names beyond those of this machine under which it may be reached
    std::filesystem::path token_file;     ///< file with the secret of whoever may look; none: everybody of this machine
    std::filesystem::path tls_cert, tls_key;
    std::filesystem::path idl; ///< of foreign types
};
void describe(config::Fields& f, AccessConfig& config);

/// What a scenario may say about the monitor; the rest is filled in by `gridspace run`.
[[nodiscard]] program::Declaration monitor_declaration();

} // namespace gridspace::monitor
