// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expectation.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// One entry of `report: figures:`: what is drawn, as data.
struct FigureSettings {
    enum class Kind {
        time_series,
        digital,
        histogram,
        ecdf,
        bar,
        scatter,
        message_intervals,
        sample_rate,
        frame_intervals,
        forged_sample,
        trip_comparison,
        roc,
        restraint,
        impedance,
        time_current
    };
    /// One expression, or a pattern that gives a line for each signal that fits.
    struct Series {
        Ref of;
        std::optional<Expression> expression; ///< nothing: `of` is none, which was said
        std::string label;                    ///< `*` stands for what the pattern's `*` stood for
        bool dashed{false}, steps{false}, right_axis{false};
        double rms_over_s{0}; ///< drawn: the root of the mean square over so long; 0: the values themselves
    };
    struct Line {
        std::string label;
        double value{0};
    };
    struct Band {
        std::string label;
        double from{0}, to{0};
    };
    /// An instant, or the first time that a condition holds.
    struct Mark {
        Ref name;
        std::string label;
        std::optional<Moment> at;
        std::optional<Expression> when;
    };
    struct Shade {
        Ref name;
        std::string label;
        std::optional<Expression> when;
    };

    Ref name;
    Kind kind{Kind::time_series};
    std::string title, label, right_label, x_label, note, zoom;
    std::vector<Series> series;
    std::optional<Expression> x; ///< scatter
    std::vector<Line> lines;
    std::vector<Band> bands;
    std::vector<Mark> marks;
    std::vector<Shade> shades;
    std::optional<Moment> from, until, zero;
    bool logarithmic{false};
    double bin{0};                 ///< histogram, in the unit of its values; 0: a fiftieth of their range
    std::string statistic{"last"}; ///< bar
    Ref streams{"*", {}};          ///< of the kinds that know streams and detectors: which
    config::SourceMark x_where{};
};

/// One entry of `report: tables:`: a row for each name, a column for each question.
struct TableSettings {
    struct Column {
        std::string name, header;
        std::vector<double> values;           ///< given, a value for each row
        std::optional<Expression> calculated; ///< from other columns
        std::vector<Expectation> measured;    ///< of each row: what is asked of the recording
        std::int64_t digits{3};
        config::SourceMark where;
    };
    Ref name;
    std::string title, row_header, note;
    std::vector<Ref> rows;
    std::vector<Column> columns;
};

/// `report:` of a scenario.
struct ReportSettings {
    std::vector<FigureSettings> figures;
    std::vector<TableSettings> tables;
    bool usual{false}; ///< also the figures of a report whose scenario lists none
};
void describe(config::Fields& f, ReportSettings& settings, config::Diagnostics& diagnostics);

/// Of a resolved scenario, or of the built-in default; what is wrong with it was said before the run.
[[nodiscard]] ReportSettings read_report_settings(config::Node const& report);

class KnownSignals;
/// Signals and events of figures and tables that are written in `file` must be those of the scenario.
void check_report(ReportSettings const& settings, std::string const& file, KnownSignals const& known,
                  config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
