// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gridspace::monitor {

/// Names come from any publisher: what is no UTF-8 is replaced, never thrown at.
[[nodiscard]] std::string json_text(nlohmann::ordered_json const& json);

/// A message for many clients.
[[nodiscard]] std::shared_ptr<std::string const> share(std::string content);

} // namespace gridspace::monitor
