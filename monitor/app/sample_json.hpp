// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace gridspace::monitor {

/// A sample decoded by the IDL text of its type: {"fields": {path: value}, "key": text}. When it cannot be decoded:
/// {"error": why}.
[[nodiscard]] nlohmann::ordered_json sample_to_json(std::string const& idl, std::string const& type,
                                                    std::span<std::byte const> cdr);

} // namespace gridspace::monitor
