// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/web/server.hpp"

#include <optional>
#include <string>

namespace gridspace::monitor {

[[nodiscard]] web::Response json_response(std::string body, int status = 200);
/// {"error": what, "remedy": …}
[[nodiscard]] web::Response problem(int status, std::string const& what, std::string const& remedy = {});
/// A number of the query; NaN when it is none; nothing when it is not there.
[[nodiscard]] std::optional<double> number(web::Target const& target, char const* name);

} // namespace gridspace::monitor
