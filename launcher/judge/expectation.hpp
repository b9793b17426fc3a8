// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "launcher/judge/expression.hpp"
#include "launcher/judge/moment.hpp"
#include "recorder/signals/signal_store.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

using config::Ref;

/// One entry of a scenario's `expect:`.
struct Expectation {
    enum class Verb {
        always,
        never,
        eventually,
        time_of,
        min_of,
        max_of,
        mean_of,
        median_of,
        p99_of,
        count_of,
        last_of,
        intervals_ms
    };

    Ref name;
    Verb verb{Verb::always};
    std::string stream; ///< of intervals_ms: "stream.TRIP2", whose rows are its messages
    std::string verb_name;
    std::optional<Expression> expression;
    std::optional<double> is, tolerance, above, below, at_least, at_most;
    std::vector<double> between;
    std::vector<double> are;        ///< of intervals_ms: the wanted intervals, in their order
    std::string unit;               ///< of time_of
    std::optional<double> within_s; ///< of eventually
    std::optional<Moment> from, until, since;
    bool show_only{false};
    bool advisory{false}; ///< shown when it fails, but the run does not fail

    /// The accepted band; open ends are infinite.
    struct Band {
        std::optional<double> low, high;
        bool low_open{false}, high_open{false};
        [[nodiscard]] bool contains(double value) const;
        [[nodiscard]] std::string to_string() const;
    };
    [[nodiscard]] Band band() const;
    [[nodiscard]] double unit_s() const; ///< of time_of: seconds in its unit
};

struct ExpectationResult {
    enum class Status { passed, failed, shown, not_applicable };
    std::string name, verb, of; ///< `of`: the expression
    std::optional<double> value;
    std::optional<double> decided_at_s; ///< of a condition: the first instant that decides it
    std::string unit;
    Expectation::Band band;
    Status status{Status::shown};
    bool advisory{false};
    std::string detail; ///< when and how it failed
};

/// Reads `expect:`.
[[nodiscard]] std::vector<Expectation> read_expectations(config::Node const& node, config::Diagnostics& diagnostics);

/// Judges an expectation by the recorded signals. `duration_s` is the simulated time of the run.
/// In lockstep an expectation on the wall clock is not applicable.
[[nodiscard]] ExpectationResult judge(Expectation const& expectation, SignalStore const& signals,
                                      Moments const& moments, double duration_s, bool lockstep = false);

} // namespace gridspace::launcher
