// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/timeline.hpp"

#include "common/text.hpp"

#include <algorithm>

namespace gridspace::launcher {

Timeline::Timeline(Expression const& expression, SignalStore const& signals, std::int64_t from_ns,
                   std::int64_t until_ns)
    : expression_{expression}, from_{from_ns}, until_{until_ns} {
    for (std::string const& pattern : expression.signals()) {
        std::vector<std::size_t> places;
        for (auto const& [name, series] : signals) {
            if (matches_glob(pattern, name)) {
                places.push_back(series_.size());
                series_.push_back(&series);
            }
        }
        if (places.empty()) {
            missing_ = pattern;
        }
        bindings_.push_back(std::move(places));
    }
    for (SignalSeries const* series : series_) {
        times_.insert(times_.end(), series->times_ns.begin(), series->times_ns.end());
    }
    times_.push_back(from_);
    std::sort(times_.begin(), times_.end());
    times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
}

} // namespace gridspace::launcher
