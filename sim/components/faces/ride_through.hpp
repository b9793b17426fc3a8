// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace gridspace::sim {

/// Bounds of voltage (p.u.) and of the deviation from nominal frequency (a share of it). What is not given does not
/// bind.
struct GridWindow {
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    double v_low{-kNone}, v_high{kNone}, f_low{-kNone}, f_high{kNone};
    [[nodiscard]] bool left(double v, double f) const { return v < v_low || v > v_high || f < f_low || f > f_high; }
    [[nodiscard]] bool within(double v, double f) const { return v > v_low && v < v_high && f > f_low && f < f_high; }
};

/// Sandia frequency shift, active detection of an island by positive feedback: the current leads the voltage by
/// pi / 2 (cf0 + K (f - f_nominal)), so that without a grid the frequency runs away until it trips. An island of
/// quality factor Q is left when K > 4 Q / (pi f_nominal). [Ye, Kolwalkar, Zhang, Du, Walling, IEEE Trans. Power
/// Electron. 19(5), 2004]
struct FrequencyShift {
    double chopping_pu{0.02}; ///< cf0, of half a period
    double gain_per_hz{0.05}; ///< K
    /// Of the current before the voltage, rad.
    [[nodiscard]] double lead_rad(double off_nominal_hz) const;

    void fields(config::Fields& f);
};

/// When a source behind a converter ceases to give current, and how it comes back.
struct GridRules {
    struct Trip {
        GridWindow window;
        double after_s{0};
    };
    std::vector<Trip> trips;             ///< outside of a window for so long: it ceases, until the grid is fit
    std::optional<GridWindow> momentary; ///< outside of it no current, which comes back along a ramp of restore_s
    double restore_s{0.4};
    GridWindow fit; ///< within it for fit_s: the current comes back along a ramp of ramp_s
    double fit_s{0.2}, ramp_s{0.4};
    std::optional<FrequencyShift> shift;

    /// What holds where nothing is configured: the voltages and times of the momentary cessation and of the must-trip
    /// limits of IEEE 1547-2018, 6.4 and 6.5, with a short return.
    [[nodiscard]] static GridRules usual();
    /// Of what draws through a converter: undervoltage blocking, and back at once. Without it its current would keep a
    /// bus alive that nobody feeds.
    [[nodiscard]] static GridRules of_load();
};

/// `ride_through:` of a converter: categories of IEEE 1547-2018, abnormal operating performance, with its default
/// settings of trips (tables 11 to 13 and 18), momentary cessation (tables 14 to 16) and of entering service (4.10,
/// table 4). Frequencies are those of a 60 Hz grid there and go with the nominal one here.
struct RideThrough {
    enum class Category { one, two, three };
    struct Trip {
        std::optional<double> at, after_s;
    };
    Category category{Category::two};
    Trip ov2, ov1, uv1, uv2, of2, of1, uf1, uf2; ///< instead of the defaults; p.u. and Hz
    std::optional<double> cease_below_pu, cease_above_pu;
    double restore_s{0.4};
    double delay_s{300}, ramp_s{300};
    std::optional<double> fit_min_pu, fit_max_pu, fit_min_hz, fit_max_hz;
    std::optional<FrequencyShift> shift;

    void fields(config::Fields& f);
    [[nodiscard]] GridRules rules(double nominal_hz) const;
};

/// The key `ride_through` of a converter.
void describe_ride_through(config::Fields& f, std::optional<RideThrough>& out);

} // namespace gridspace::sim
