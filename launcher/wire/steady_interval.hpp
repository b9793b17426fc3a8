// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

namespace gridspace::wire {

/// Between a GOOSE message and the one before it.
struct MessageInterval {
    double ms{0};
    bool same_state{false}; ///< both have the same stNum: a repetition, not a change of state
};

/// Median of the intervals at which a publisher has arrived at its MaxTime. `intervals` are in the order of the
/// messages. Nothing when there are none: a stream that changes again and again, or is still in its burst.
[[nodiscard]] std::optional<double> steady_interval_ms(std::span<MessageInterval const> intervals);

} // namespace gridspace::wire
