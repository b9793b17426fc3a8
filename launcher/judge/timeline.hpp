// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expression.hpp"
#include "recorder/signals/signal_store.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Steps through the values of an expression in a window of time. Expression and signals must outlive it.
class Timeline {
  public:
    Timeline(Expression const& expression, SignalStore const& signals, std::int64_t from_ns, std::int64_t until_ns);

    [[nodiscard]] std::string const& missing() const { return missing_; } ///< a pattern that no signal fits
    [[nodiscard]] std::vector<SignalSeries const*> const& series() const { return series_; }
    [[nodiscard]] std::int64_t from() const { return from_; }
    [[nodiscard]] std::int64_t until() const { return until_; }

    /// Calls visit(time, value) at every change in the window, the held value at its begin first; false stops.
    template <class Visit>
    void run(Visit const& visit) const {
        std::vector<double> values(series_.size(), std::numeric_limits<double>::quiet_NaN());
        std::vector<std::size_t> next(series_.size(), 0);
        std::size_t unknown = series_.size();
        for (std::int64_t const t : times_) {
            if (t > until_) {
                return;
            }
            for (std::size_t i = 0; i < series_.size(); ++i) {
                auto const& times = series_[i]->times_ns;
                for (; next[i] < times.size() && times[next[i]] <= t; ++next[i]) {
                    unknown -= next[i] == 0 ? 1 : 0;
                    values[i] = series_[i]->values[next[i]];
                }
            }
            if (t >= from_ && unknown == 0 && !visit(t, expression_.evaluate(bindings_, values))) {
                return;
            }
        }
    }

  private:
    Expression const& expression_;
    std::int64_t from_, until_;
    std::vector<SignalSeries const*> series_;
    Expression::Bindings bindings_;
    std::vector<std::int64_t> times_;
    std::string missing_;
};

} // namespace gridspace::launcher
