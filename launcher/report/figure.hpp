// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::launcher {

/// A plot over time, or over something else (`x_label`), as data: drawn as SVG, exported as CSV.
struct Figure {
    std::string id; ///< file name without its ending
    std::string title;
    std::string y_label, right_label;
    struct Series {
        std::string name; ///< empty: it belongs to another series and stands in no legend
        std::vector<std::int64_t> times_ns;
        std::vector<double> values;
        bool steps{false}; ///< a value holds until the next one
        bool dashed{false};
        int colour{-1};       ///< of the palette; -1: by its place
        bool points{false};   ///< a dot for each value, too
        bool connected{true}; ///< a line through the values
        bool bars{false};     ///< a bar from 0 to each value instead
        bool right_axis{false};
        std::vector<std::string> point_names{}; ///< beside the dots; empty, or one for each value
        bool double_point{false};               ///< a breaker's position: in a lane it is up where that is open
        bool path{false};                       ///< of places in their order, which need not increase
    };
    std::vector<Series> series;
    struct Line {
        std::string label;
        double value{0};
    };
    std::vector<Line> lines; ///< horizontal: limits and thresholds
    struct Band {
        std::string label;
        double low{0}, high{0};
    };
    std::vector<Band> bands; ///< horizontal: what is allowed
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
    double zero_s{0};                   ///< times are shown relative to it
    std::string zero_name{};            ///< "fault": what they are relative to
    std::string x_label;                ///< of an axis that is not time; then a "second" is one of its units
    std::vector<std::string> x_names{}; ///< of the places 0, 1, 2 … of such an axis, instead of numbers
    std::string axis{"time"};           ///< figures with the same axis zoom together
    bool log_y{false};
    bool log_x{false};                                  ///< "times" are decimal logarithms
    std::optional<std::pair<double, double>> y_range{}; ///< what is shown, of a logarithmic axis as decimal logarithms
    double plot_height{238};
    bool zero_axes{false}; ///< a plane: both axes through the origin
    bool lanes{false};     ///< digital: each series in a lane of its own, up where it is not zero
    std::string note;      ///< the method, below the drawing

    /// Has a cursor and zooms.
    [[nodiscard]] bool interactive() const;
};

/// Hours for long runs, seconds, or milliseconds.
struct TimeUnit {
    std::string name;
    double seconds{1};
};
[[nodiscard]] TimeUnit time_unit(double span_s);

/// A colour of the palette, which is told apart with any colour vision; `place` where none is wanted (-1).
[[nodiscard]] std::string_view palette_colour(int wanted, std::size_t place);

/// What is drawn of a series: seconds and values, a few thousand at most, the extremes of each bucket kept.
[[nodiscard]] std::vector<std::pair<double, double>> drawn_points(Figure::Series const& series, double from_s,
                                                                  double to_s);

/// Leaves of a series with more than a million values those that the window shows, and of these, when they are still
/// more, what is drawn: an hour of samples is for the recording and not for a figure's table.
void shorten(Figure::Series& series, double from_s, double to_s);

/// A complete drawing that stands alone; it carries what the report's script needs.
[[nodiscard]] std::string to_svg(Figure const& figure);

/// One row per instant: time_s, then a column per series; empty where a series has no value yet. Of a figure with paths
/// a row per point: series, x, value.
[[nodiscard]] std::string to_csv(Figure const& figure);

/// The values of all series at a few thousand instants, as JSON that may stand in a script element (for the report's
/// cursor).
[[nodiscard]] std::string to_json(Figure const& figure);

} // namespace gridspace::launcher
