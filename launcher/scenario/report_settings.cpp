// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/report_settings.hpp"

#include "common/text.hpp"
#include "launcher/scenario/known_signals.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using FigureKind = FigureSettings::Kind;

/// The kinds that are drawn from expressions; the others know what they draw.
bool draws_expressions(FigureKind kind) {
    return kind <= FigureKind::scatter;
}

std::string label_of(std::string const& written, Ref const& name) {
    if (!written.empty()) {
        return written;
    }
    std::string out = name.name;
    std::replace(out.begin(), out.end(), '_', ' ');
    return out;
}

/// A key that holds an expression; nothing, and said, when it is none.
std::optional<Expression> expression(Fields& f, std::string_view key, std::string_view doc) {
    std::string text;
    f.text(key, text, {.doc = doc});
    if (text.empty()) {
        return std::nullopt;
    }
    auto parsed = Expression::parse(text);
    if (!parsed) {
        f.error(key, parsed.error().message);
        return std::nullopt;
    }
    return std::move(*parsed);
}

void describe_series(Fields& f, FigureSettings& s) {
    std::vector<Ref> signals;
    f.references("signals", signals,
                 {.doc = "what is drawn: signals, patterns (a line for each signal that fits), expressions"});
    for (Ref& written : signals) {
        FigureSettings::Series series;
        if (auto parsed = Expression::parse(written.name)) {
            series.expression = std::move(*parsed);
        } else {
            f.error("signals", parsed.error().message);
        }
        series.of = std::move(written);
        s.series.push_back(std::move(series));
    }
    f.map("series", {.doc = "the same with more to say about each; after `signals`"}, [&](Ref const& name, Fields& g) {
        FigureSettings::Series series;
        series.expression = expression(g, "of", "a signal, a pattern or an expression");
        series.of = {series.expression ? series.expression->text() : "", g.where("of")};
        g.text("label", series.label,
               {.doc = "in the legend; `*` stands for what the pattern's `*` stood for: \"* reference\""});
        g.flag("dashed", series.dashed, {.doc = "a dashed line"});
        g.flag("steps", series.steps, {.doc = "a value holds until the next one"});
        g.flag("right_axis", series.right_axis, {.doc = "on an axis of its own, at the right"});
        g.number("rms_over_s", series.rms_over_s,
                 {.doc = "drawn is the root of the mean square over so long; 0: the values", .min = 0});
        if (!g.has("of")) {
            g.error("", fmt::format("series '{}' says nothing of what it draws", name.name),
                    "of: a signal, a pattern or an expression");
        }
        s.series.push_back(std::move(series));
    });
}

void describe_additions(Fields& f, FigureSettings& s) {
    f.map("lines", {.doc = "horizontal lines: limits and thresholds"}, [&](Ref const& name, Fields& g) {
        FigureSettings::Line line;
        g.number("value", line.value, {.doc = "where", .required = true});
        g.text("label", line.label, {.doc = "beside it; without it, its name"});
        line.label = label_of(line.label, name);
        s.lines.push_back(std::move(line));
    });
    f.map("bands", {.doc = "horizontal bands: what is allowed"}, [&](Ref const& name, Fields& g) {
        FigureSettings::Band band;
        g.number("from", band.from, {.doc = "lower bound", .required = true});
        g.number("to", band.to, {.doc = "upper bound", .required = true});
        g.text("label", band.label, {.doc = "in it; without it, its name"});
        band.label = label_of(band.label, name);
        if (g.has("from") && g.has("to") && band.from >= band.to) {
            g.error("to",
                    fmt::format("band '{}' ends at {}, and begins at {}", name.name, shortest(band.to),
                                shortest(band.from)),
                    "the lower bound belongs first");
        }
        s.bands.push_back(std::move(band));
    });
    f.map("marks", {.doc = "vertical lines at instants; what did not happen is not drawn"},
          [&](Ref const& name, Fields& g) {
              FigureSettings::Mark mark;
              mark.name = name;
              g.text("label", mark.label, {.doc = "above it; without it, its name"});
              mark.label = label_of(mark.label, name);
              describe_moment(g, "at", mark.at, "an event, with an offset (`fault + 2 s`), or a time (`4 h`)");
              mark.when = expression(g, "when", "or the first time that this holds, from the figure's begin on");
              if (g.has("at") == g.has("when")) {
                  g.error("", fmt::format("mark '{}' needs `at` or `when`", name.name),
                          "at: fault; or when: breaker.CB3.position == open");
              }
              s.marks.push_back(std::move(mark));
          });
    f.map("shades", {.doc = "spans of time in which something holds"}, [&](Ref const& name, Fields& g) {
        FigureSettings::Shade shade;
        shade.name = name;
        g.text("label", shade.label, {.doc = "in the legend; without it, its name"});
        shade.label = label_of(shade.label, name);
        shade.when = expression(g, "when", "what holds: a signal that is not zero, or an expression");
        if (!g.has("when")) {
            g.error("", fmt::format("shade '{}' does not say `when`", name.name));
        }
        s.shades.push_back(std::move(shade));
    });
}

void describe_figure(Fields& f, FigureSettings& s) {
    f.choice<FigureKind>("kind", s.kind,
                         {{"time_series", FigureKind::time_series},
                          {"digital", FigureKind::digital},
                          {"histogram", FigureKind::histogram},
                          {"ecdf", FigureKind::ecdf},
                          {"bar", FigureKind::bar},
                          {"scatter", FigureKind::scatter},
                          {"message_intervals", FigureKind::message_intervals},
                          {"sample_rate", FigureKind::sample_rate},
                          {"frame_intervals", FigureKind::frame_intervals},
                          {"forged_sample", FigureKind::forged_sample},
                          {"trip_comparison", FigureKind::trip_comparison},
                          {"roc", FigureKind::roc},
                          {"restraint", FigureKind::restraint},
                          {"impedance", FigureKind::impedance},
                          {"time_current", FigureKind::time_current}},
                         {.doc = "how it is drawn: docs/reference/report.md"});
    f.text("title", s.title, {.doc = "above it; without it, its name"});
    s.title = label_of(s.title, s.name);
    f.text("label", s.label, {.doc = "of the axis, with the unit: voltage, p.u."});
    f.text("right_label", s.right_label, {.doc = "of the axis at the right"});
    f.text("x_label", s.x_label, {.doc = "of the horizontal axis, where that is not time"});
    f.text("note", s.note, {.doc = "below it: the method"});
    f.text("zoom", s.zoom, {.doc = "figures with the same word here zoom together; without it, those of one window"});
    describe_series(f, s);
    s.x = expression(f, "x", "scatter: the horizontal value, an expression");
    s.x_where = f.where("x");
    describe_additions(f, s);
    describe_moment(f, "from", s.from, "begin of what is shown: an event with an offset, or a time");
    describe_moment(f, "until", s.until, "end of it");
    describe_moment(f, "zero", s.zero, "times are shown relative to this instant");
    f.flag("logarithmic", s.logarithmic, {.doc = "a logarithmic axis of values"});
    f.number("bin", s.bin, {.doc = "histogram: width of a bin; 0: a fiftieth of the range", .min = 0});
    f.text("statistic", s.statistic, {.doc = "bar: last, min, max or mean of the window"});
    f.reference("streams", s.streams,
                {.doc = "message_intervals, sample_rate, frame_intervals, forged_sample, roc: pattern of the streams; "
                        "trip_comparison, restraint, impedance, time_current: of the relays"});
    if (s.statistic != "last" && s.statistic != "min" && s.statistic != "max" && s.statistic != "mean") {
        f.error("statistic", fmt::format("'{}' is not a statistic", s.statistic), "last, min, max or mean");
    }
    if (draws_expressions(s.kind) && !f.has("signals") && !f.has("series")) {
        f.error("", fmt::format("figure '{}' draws nothing", s.name.name),
                "signals: [bus.*.v_pu], or series: {NAME: {of: …}}");
    }
    if ((s.kind == FigureKind::scatter) != f.has("x")) {
        f.error(f.has("x") ? "x" : "", fmt::format("figure '{}': `x` and `kind: scatter` go together", s.name.name));
    }
    if (s.from && s.until && s.from->event == s.until->event && s.from->offset_s >= s.until->offset_s) {
        f.error("until", fmt::format("figure '{}' ends at '{}', not after its begin '{}'", s.name.name,
                                     to_text(*s.until), to_text(*s.from)));
    }
}

/// What the recording is asked about each row: the column with `{row}` replaced by its name.
Node of_row(Node node, std::string const& row) {
    constexpr std::string_view kPlace = "{row}";
    for (std::size_t at = 0; (at = node.text.find(kPlace, at)) != std::string::npos; at += row.size()) {
        node.text.replace(at, kPlace.size(), row);
    }
    for (Node::Entry& entry : node.entries) {
        entry.value = of_row(std::move(entry.value), row);
    }
    return node;
}

void read_column(Node::Entry const& entry, TableSettings const& table, TableSettings::Column& out, Diagnostics& d) {
    static constexpr std::array<std::string_view, 4> kOwn{"header", "values", "calculate", "digits"};
    Node own = Node::map(entry.value.where), question = Node::map(entry.value.where);
    for (Node::Entry const& key : entry.value.entries) {
        bool const mine = std::find(kOwn.begin(), kOwn.end(), key.key) != kOwn.end();
        (mine ? own : question).entries.push_back(key);
    }
    config::read_fields(own, "column " + entry.key, d, [&](Fields& f) {
        f.text("header", out.header);
        f.numbers("values", out.values);
        f.integer("digits", out.digits, {.min = 0, .max = 12});
        out.calculated = expression(f, "calculate", "");
        if (f.has("values") && out.values.size() != table.rows.size()) {
            f.error("values", fmt::format("column '{}' has {} values, and the table {} rows", entry.key,
                                          out.values.size(), table.rows.size()));
        }
    });
    if (int const ways = (own.find("values") != nullptr) + (own.find("calculate") != nullptr) +
                         static_cast<int>(!question.entries.empty());
        ways != 1) {
        d.error(entry.where, fmt::format("column '{}' has {} sources of its values", entry.key, ways),
                "exactly one of: values, calculate, or a question as in `expect:` (last_of, time_of, …)",
                static_cast<int>(entry.key.size()));
        return;
    }
    if (question.entries.empty()) {
        return;
    }
    question.set("show_only", Node::scalar("true", entry.where));
    for (Ref const& row : table.rows) {
        Node cell = Node::map(entry.where);
        cell.entries.push_back({entry.key, entry.where, of_row(question, row.name)});
        Diagnostics once; // what is wrong in every row is said once
        for (Expectation& e : read_expectations(cell, &row == &table.rows.front() ? d : once)) {
            out.measured.push_back(std::move(e));
        }
    }
}

void describe_table(Fields& f, TableSettings& t, Diagnostics& diagnostics) {
    f.text("title", t.title, {.doc = "above it; without it, its name"});
    t.title = label_of(t.title, t.name);
    f.text("row_header", t.row_header, {.doc = "above the names of the rows"});
    f.text("note", t.note, {.doc = "below it: the method"});
    f.references("rows", t.rows, {.doc = "names of the rows", .required = true});
    Node columns;
    f.raw("columns", columns,
          {.doc = "by name: `header`, `digits`, and one of `values` (a number for each row), `calculate` (from columns "
                  "before it: column.NAME) or a question as in `expect:` in which {row} stands for the row",
           .required = true});
    if (!columns.is_map() && !columns.is_null()) {
        f.error("columns", fmt::format("the columns of table '{}' are {}", t.name.name, config::describe(columns)),
                "a map from names to columns");
    }
    for (Node::Entry const& entry : columns.entries) {
        TableSettings::Column column;
        column.name = column.header = entry.key;
        column.where = entry.where;
        read_column(entry, t, column, diagnostics);
        t.columns.push_back(std::move(column));
    }
    for (TableSettings::Column const& column : t.columns) {
        for (std::string const& signal :
             column.calculated ? column.calculated->signals() : std::vector<std::string>{}) {
            std::vector<std::string> before;
            for (TableSettings::Column const& other : t.columns) {
                if (&other == &column) {
                    break;
                }
                before.push_back("column." + other.name);
            }
            if (std::find(before.begin(), before.end(), signal) == before.end()) {
                diagnostics.error(column.where,
                                  fmt::format("column '{}' is calculated from '{}', which is no column before it",
                                              column.name, signal),
                                  did_you_mean(signal, before), static_cast<int>(column.name.size()));
            }
        }
    }
}

} // namespace

void describe(Fields& f, ReportSettings& settings, Diagnostics& diagnostics) {
    f.flag("usual", settings.usual,
           {.doc = "also the figures that a report has whose scenario lists none, after those listed here"});
    f.map("figures", {.doc = "what is drawn, in this order; without it: voltages, frequency, powers, breakers, …"},
          [&](Ref const& name, Fields& g) {
              FigureSettings figure;
              figure.name = name;
              describe_figure(g, figure);
              settings.figures.push_back(std::move(figure));
          });
    f.map("tables", {.doc = "tables of values, above the figures"}, [&](Ref const& name, Fields& g) {
        TableSettings table;
        table.name = name;
        describe_table(g, table, diagnostics);
        settings.tables.push_back(std::move(table));
    });
}

ReportSettings read_report_settings(Node const& report) {
    ReportSettings out;
    Diagnostics ignored;
    if (report.is_map()) {
        config::read_fields(report, "report", ignored, [&](Fields& f) { describe(f, out, ignored); });
    }
    return out;
}

void check_report(ReportSettings const& settings, std::string const& file, KnownSignals const& known,
                  Diagnostics& diagnostics) {
    // What an inherited figure is about may have been removed from the scenario; it is left out then.
    auto const inherited = [&](config::SourceMark const& where) {
        return where.source != nullptr && where.source->name != file && !where.source->name.starts_with("--");
    };
    auto const check = [&](auto const& what, std::string const& user, config::SourceMark const& where,
                           std::size_t width) {
        if (!inherited(where)) {
            known.check(what, {user, where, static_cast<int>(width)}, diagnostics);
        }
    };
    auto const signals_of = [](std::optional<Expression> const& e) {
        return e ? e->signals() : std::vector<std::string>{};
    };
    for (FigureSettings const& figure : settings.figures) {
        std::string const user = fmt::format("figure '{}'", figure.name.name);
        for (FigureSettings::Series const& s : figure.series) {
            check(signals_of(s.expression), user, s.of.where, s.of.name.size());
        }
        check(signals_of(figure.x), user, figure.x_where, figure.x ? figure.x->text().size() : 0);
        if (!inherited(figure.streams.where)) {
            known.check_name(figure.streams.name,
                             {user, figure.streams.where, static_cast<int>(figure.streams.name.size())}, diagnostics);
        }
        for (FigureSettings::Mark const& mark : figure.marks) {
            check(signals_of(mark.when), user, mark.name.where, mark.name.name.size());
            check(mark.at, user, mark.name.where, mark.name.name.size());
        }
        for (FigureSettings::Shade const& shade : figure.shades) {
            check(signals_of(shade.when), user, shade.name.where, shade.name.name.size());
        }
        for (std::optional<Moment> const* moment : {&figure.from, &figure.until, &figure.zero}) {
            check(*moment, user, figure.name.where, figure.name.name.size());
        }
    }
    for (TableSettings const& table : settings.tables) {
        for (TableSettings::Column const& column : table.columns) {
            std::string const user = fmt::format("table '{}', column '{}',", table.name.name, column.name);
            for (Expectation const& e : column.measured) {
                check(signals_of(e.expression), user, column.where, column.name.size());
                for (std::optional<Moment> const* moment : {&e.from, &e.until, &e.since}) {
                    check(*moment, user, column.where, column.name.size());
                }
            }
        }
    }
}

} // namespace gridspace::launcher
