// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// A plot over time, or over something else (`x_label`), as data: drawn as SVG, exported as CSV.
struct Figure {
    std::string id; ///< file name without its ending
    std::string title;
    std::string y_label;
    struct Series {
        std::string name;
        std::vector<std::int64_t> times_ns;
        std::vector<double> values;
        bool steps{false}; ///< a value holds until the next one
        bool dashed{false};
        int colour{-1};     ///< of the palette; -1: by its place
        bool points{false}; ///< a dot for each value, too
    };
    std::vector<Series> series;
    struct Line {
        std::string label;
        double value{0};
    };
    std::vector<Line> lines; ///< horizontal: limits and thresholds
    struct Mark {
        std::string label;
        double time_s{0};
        int colour{-1};
    };
    std::vector<Mark> marks; ///< vertical: deadlines and events
    struct Shade {
        double from_s{0}, to_s{0};
    };
    std::vector<Shade> shades;
    std::string shade_label;
    double from_s{0}, to_s{0};
    std::string x_label;      ///< of an axis that is not time; then a "second" is one of its units
    std::string axis{"time"}; ///< figures with the same axis zoom together
    bool log_y{false};
    std::string note; ///< the method, below the drawing
};

/// Hours for long runs, seconds, or milliseconds.
struct TimeUnit {
    std::string name;
    double seconds{1};
};
[[nodiscard]] TimeUnit time_unit(double span_s);

/// A complete drawing that stands alone; `interactive` adds what the report's script needs.
[[nodiscard]] std::string to_svg(Figure const& figure);

/// One row per instant: time_s, then a column per series; empty where a series has no value yet.
[[nodiscard]] std::string to_csv(Figure const& figure);

/// The values of all series at a few thousand instants, as JSON that may stand in a script element (for the report's
/// cursor).
[[nodiscard]] std::string to_json(Figure const& figure);

} // namespace gridspace::launcher
