// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::fmi {

/// What a function of the standard says about its call. In both versions in this order.
enum class Status : int { ok, warning, discard, error, fatal, pending };
[[nodiscard]] std::string_view name_of(Status status) noexcept; ///< "error"

} // namespace gridspace::fmi
