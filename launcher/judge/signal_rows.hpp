// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "recorder/signals/signal_store.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What `breaker.*.position`, `.pole.*` and `fuse.*.position` hold (IEC 61850-7-3, double point): open, closed.
inline constexpr double kOpenPosition = 1, kClosedPosition = 2;

/// A recorded signal; nullptr where there is none, or one without values.
[[nodiscard]] SignalSeries const* series_of(SignalStore const& signals, std::string const& name);
/// Its values; none where there is no such signal.
[[nodiscard]] std::vector<double> values_of(SignalStore const& signals, std::string const& name);
/// Indices of the rows in which a signal leaves zero; none of nullptr.
[[nodiscard]] std::vector<std::size_t> rises(SignalSeries const* series);

} // namespace gridspace::launcher
