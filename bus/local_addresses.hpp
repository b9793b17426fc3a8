// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <chrono>
#include <string>
#include <vector>

namespace gridspace::bus {

/// Waits until each of these IPv4 addresses belongs to an interface that is up and has a carrier: a participant that is
/// made before would never receive. Says after a moment what it waits for. Fails (environment) when `patience` is over.
[[nodiscard]] Result<void> wait_for_addresses(std::vector<std::string> const& addresses,
                                              std::chrono::milliseconds patience);

} // namespace gridspace::bus
