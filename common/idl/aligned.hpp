// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace gridspace::idl {

/// The next offset from `at` on that is a multiple of `to`.
[[nodiscard]] constexpr std::size_t aligned(std::size_t at, std::size_t to) {
    return (at + to - 1) / to * to;
}

} // namespace gridspace::idl
