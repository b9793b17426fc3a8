// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expectation.hpp"

#include <string>

namespace gridspace::launcher {

/// What an expectation asks, for people: "time of breaker.CB3.position == open, since fault".
[[nodiscard]] std::string rule_of(Expectation const& expectation);

} // namespace gridspace::launcher
