// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/detector_roc.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace gridspace::launcher {

std::vector<RocPoint> roc_of(IntrusionRecording const& recording, IntrusionRecording::Track const& track) {
    std::set<std::pair<std::int64_t, std::uint8_t>> forged;
    for (IntrusionRecording::Label const& l : recording.labels) {
        if (l.target == track.stream) {
            forged.emplace(l.index, l.channel);
        }
    }
    std::vector<double> fakes, genuine; ///< distance from the forecast, in thresholds
    for (auto const& s : track.samples) {
        for (std::uint8_t p = 0; p < 3; ++p) {
            auto const& v = s.phases[p];
            if (v.judged && v.limit_a > 0) {
                (forged.contains({s.index, p}) ? fakes : genuine)
                    .push_back(std::fabs(double{v.raw_a} - v.open_forecast_a) / v.limit_a);
            }
        }
    }
    std::vector<RocPoint> out;
    if (fakes.empty() || genuine.empty()) {
        return out;
    }
    std::sort(fakes.begin(), fakes.end());
    std::sort(genuine.begin(), genuine.end());
    auto const above = [](std::vector<double> const& sorted, double limit) {
        auto const n = sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), limit);
        return 100.0 * static_cast<double>(n) / static_cast<double>(sorted.size());
    };
    for (int k = -10; k <= 16; ++k) {
        double const m = std::pow(10, k / 10.0);
        out.push_back({m, above(genuine, m), above(fakes, m)});
    }
    return out;
}

} // namespace gridspace::launcher
