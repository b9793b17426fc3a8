// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

#include <vector>

namespace gridspace::sim {

struct ProfileHalfSine {
    double rise_h{6}, set_h{18}, exponent{1};
};

/// A value over time that multiplies powers.
struct Profile final : Element {
    static constexpr Kind kKind{.section = "profiles", .doc = "values over time", .word = "profile"};
    enum class Time { since_start, hour_of_day } time{Time::since_start};
    std::vector<double> hours, values; ///< linear between points, constant outside
    using HalfSine = ProfileHalfSine;
    std::optional<HalfSine> half_sine;
    struct Cloud {
        double at_h{12}, depth_percent{0}, width_h{0.1};
    };
    std::vector<Cloud> clouds;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    /// At a simulated time (hours since start) when simulated time 0 is `start_hour_of_day`.
    [[nodiscard]] double value_at(double hours_since_start, double start_hour_of_day) const;
};

} // namespace gridspace::sim
