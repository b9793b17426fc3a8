// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expectation.hpp"
#include "launcher/judge/timeline.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

/// What signals and expressions do in the window of a timeline.
namespace gridspace::launcher {

/// A number that is no number is not true.
[[nodiscard]] inline bool is_true(double value) {
    return value != 0 && !std::isnan(value);
}

[[nodiscard]] std::string seconds_text(std::int64_t ns);

/// The least, the largest, ... value, as the verb says; nothing where there are no values.
[[nodiscard]] std::optional<double> statistic(Expectation const& e, Timeline const& timeline);

/// Where a delay in the window is below zero, and what that says: nothing arrives before it was sent. Empty: nowhere.
[[nodiscard]] std::string clocks_apart(SignalStore const& signals, Expression const& expression,
                                       Timeline const& timeline);

/// How often the expression becomes true and false, and at how many samples it is true.
struct Edges {
    bool any{false}; ///< the expression has a value in the window
    std::int64_t rises{0}, falls{0}, true_samples{0};
};

[[nodiscard]] Edges edges_of(Timeline const& timeline);

/// When a condition becomes what is waited for.
struct Fulfilment {
    std::optional<std::int64_t> at;         ///< the first time at or after the begin
    std::optional<std::int64_t> true_since; ///< it was so before the begin already, from here on
};

/// `timeline` starts before `begin`, so that what becomes true at `begin` is told from what was true before. With
/// `rises` and `falls` the next edge counts; without, a condition whose first value is true has become so with that
/// value.
[[nodiscard]] Fulfilment fulfilment_of(Timeline const& timeline, Expression::Edge edge, std::int64_t begin);

} // namespace gridspace::launcher
