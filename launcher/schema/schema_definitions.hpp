// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gridspace::launcher {

/// A JSON schema in which what it says more than once is said in `$defs` and referred to from there; it accepts the
/// same. In lines of up to 120 characters: what fits into one stands in one.
[[nodiscard]] std::string with_definitions(std::string const& schema);

} // namespace gridspace::launcher
