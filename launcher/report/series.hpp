// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/process_ends.hpp"
#include "launcher/report/figure.hpp"
#include "launcher/scenario/report_settings.hpp"
#include "recorder/signals/signal_store.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::launcher {

/// What the `*` of a pattern stand for in a name: {"CT21", "a"} of "ct.CT21.i.a" by "ct.*.i.*". Nothing: it does not
/// fit.
[[nodiscard]] std::optional<std::vector<std::string>> captures(std::string_view pattern, std::string_view name);

/// Lets what is called the same have the same colour within a figure, and a phase the same everywhere.
class Colours {
  public:
    [[nodiscard]] int of(std::string const& name);

  private:
    std::map<std::string, int> known_;
};

/// The series of an entry of `signals:` or `series:`, from the begin of the run to `until_s`. What is silent has no
/// value (NaN) there. `not_measurable` gets delays below zero, which are no delays.
[[nodiscard]] std::vector<Figure::Series> drawn_series(FigureSettings::Series const& settings,
                                                       SignalStore const& signals, Silences const& silences,
                                                       double until_s, Colours& colours,
                                                       std::vector<std::string>& not_measurable);

/// An expression (or a single signal) as a series of its changes.
[[nodiscard]] SignalSeries values_of(Expression const& expression, SignalStore const& signals, double until_s);

/// The root of the mean square over the `window_s` before each value.
[[nodiscard]] std::vector<double> sliding_rms(std::vector<std::int64_t> const& times_ns,
                                              std::vector<double> const& values, double window_s);

/// Bins of a histogram, whatever width is asked for.
inline constexpr double kMostBins = 100'000;

/// A value as a place on an axis that is not time.
[[nodiscard]] std::int64_t as_place(double value);

/// The first time in a window at which a signal has a value and is not zero; seconds.
[[nodiscard]] std::optional<double> rises(SignalStore const& signals, std::string const& name, double from_s,
                                          double to_s);

/// Spans in which an expression is true.
[[nodiscard]] std::vector<Figure::Shade> spans(Expression const& expression, SignalStore const& signals,
                                               double until_s);

/// The first time at or after `from_s` at which it is true.
[[nodiscard]] std::optional<double> first_true(Expression const& expression, SignalStore const& signals, double from_s,
                                               double until_s);

} // namespace gridspace::launcher
