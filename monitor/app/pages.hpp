// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/web/server.hpp"

#include <optional>

namespace gridspace::monitor {

/// The pages and their parts, which are in the program itself; nothing for a path that is none of them.
[[nodiscard]] std::optional<web::Response> page_of(web::Request const& request);

} // namespace gridspace::monitor
