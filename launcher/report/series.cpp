// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/series.hpp"

#include "common/text.hpp"
#include "launcher/judge/timeline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::launcher {
namespace {

std::int64_t nanoseconds(double seconds) {
    return std::llround(seconds * 1e9);
}

/// "* reference" with what the pattern's `*` stood for; the last `*` takes what is left.
std::string labelled(std::string const& label, std::vector<std::string> const& captured) {
    std::string out;
    std::size_t next = 0;
    for (std::size_t i = 0; i < label.size(); ++i) {
        if (label[i] != '*') {
            out += label[i];
            continue;
        }
        bool const last = label.find('*', i + 1) == std::string::npos;
        std::size_t const end = last ? captured.size() : std::min(captured.size(), next + 1);
        std::vector<std::string> const part(captured.begin() + static_cast<std::ptrdiff_t>(std::min(next, end)),
                                            captured.begin() + static_cast<std::ptrdiff_t>(end));
        out += join(part, " ");
        next = end;
    }
    return out;
}

/// A value that holds into a silence ends where that begins.
void keep_silent(Figure::Series& series, std::vector<Silence> const& silences, std::int64_t until_ns) {
    for (Silence const& silence : silences) {
        auto const place = [&](std::int64_t time_ns) {
            return std::upper_bound(series.times_ns.begin(), series.times_ns.end(), time_ns) - series.times_ns.begin();
        };
        auto const from = place(silence.from_ns), until = std::max(from, place(silence.until_ns - 1));
        if (from == 0 || silence.from_ns >= until_ns) {
            continue; // it had no value yet, or the run was over
        }
        series.times_ns.erase(series.times_ns.begin() + from, series.times_ns.begin() + until);
        series.values.erase(series.values.begin() + from, series.values.begin() + until);
        series.times_ns.insert(series.times_ns.begin() + from, silence.from_ns);
        series.values.insert(series.values.begin() + from, std::numeric_limits<double>::quiet_NaN());
    }
}

bool is_no_delay(std::string const& name, SignalSeries const& series) {
    return is_wall_clock_signal(name) && name.ends_with("_ms") &&
           std::any_of(series.values.begin(), series.values.end(), [](double v) { return v < -1e-6; });
}

} // namespace

std::optional<std::vector<std::string>> captures(std::string_view pattern, std::string_view name) {
    if (!matches_glob(pattern, name)) {
        return std::nullopt; // so that below the first end whose rest matches is the right one, and no other is tried
    }
    std::size_t const star = pattern.find('*');
    std::string_view const head = pattern.substr(0, star);
    if (head.size() > name.size() || !matches_glob(head, name.substr(0, head.size()))) {
        return std::nullopt;
    }
    if (star == std::string_view::npos) {
        return head.size() == name.size() ? std::optional<std::vector<std::string>>{std::in_place} : std::nullopt;
    }
    for (std::size_t end = head.size(); end <= name.size(); ++end) {
        if (auto rest = captures(pattern.substr(star + 1), name.substr(end))) {
            rest->insert(rest->begin(), std::string{name.substr(head.size(), end - head.size())});
            return rest;
        }
    }
    return std::nullopt;
}

int Colours::of(std::string const& name) {
    std::string const last = name.substr(name.find_last_of(" .") + 1); // npos + 1 is 0
    if (last == "a" || last == "b" || last == "c") {
        return last[0] - 'a';
    }
    return known_.try_emplace(name, static_cast<int>(known_.size())).first->second;
}

SignalSeries values_of(Expression const& expression, SignalStore const& signals, double until_s) {
    if (expression.is_plain_signal()) {
        auto const it = signals.find(expression.signals().front());
        return it == signals.end() ? SignalSeries{} : it->second;
    }
    SignalSeries out;
    Timeline const timeline{expression, signals, 0, nanoseconds(until_s)};
    if (timeline.missing().empty()) {
        timeline.run([&](std::int64_t t, double value) {
            out.times_ns.push_back(t);
            out.values.push_back(value);
            return true;
        });
    }
    return out;
}

std::vector<double> sliding_rms(std::vector<std::int64_t> const& times_ns, std::vector<double> const& values,
                                double window_s) {
    std::vector<double> out;
    out.reserve(values.size());
    double squares = 0;
    std::size_t first = 0, unknown = 0; // NaN in the window
    auto const count = [&](double value, int sign) {
        if (std::isnan(value)) {
            unknown += sign > 0 ? 1 : -std::size_t{1};
        } else {
            squares += sign * value * value;
        }
    };
    for (std::size_t i = 0; i < values.size(); ++i) {
        count(values[i], 1);
        // Half a nanosecond less: a window of whole samples takes as many samples at every rounding of the times.
        while (static_cast<double>(times_ns[i] - times_ns[first]) >= window_s * 1e9 - 500) {
            count(values[first++], -1);
        }
        out.push_back(unknown > 0 ? std::numeric_limits<double>::quiet_NaN()
                                  : std::sqrt(std::max(0.0, squares) / static_cast<double>(i - first + 1)));
    }
    return out;
}

std::vector<Figure::Series> drawn_series(FigureSettings::Series const& settings, SignalStore const& signals,
                                         Silences const& silences, double until_s, Colours& colours,
                                         std::vector<std::string>& not_measurable) {
    std::vector<Figure::Series> out;
    auto const add = [&](std::string const& name, std::string const& key, std::vector<std::string> const& made_of,
                         SignalSeries series) {
        if (series.values.empty()) {
            return;
        }
        Figure::Series drawn;
        drawn.name = name;
        drawn.times_ns = std::move(series.times_ns);
        drawn.values = settings.rms_over_s > 0 ? sliding_rms(drawn.times_ns, series.values, settings.rms_over_s)
                                               : std::move(series.values);
        drawn.steps = settings.steps;
        drawn.dashed = settings.dashed;
        drawn.double_point = series.unit == "dpc";
        drawn.right_axis = settings.right_axis;
        drawn.colour = colours.of(key);
        for (auto const& [signal, of_signal] : silences) {
            if (std::any_of(made_of.begin(), made_of.end(), [&](auto const& p) { return matches_glob(p, signal); })) {
                keep_silent(drawn, of_signal, nanoseconds(until_s));
            }
        }
        out.push_back(std::move(drawn));
    };
    if (!settings.expression) {
        return out;
    }
    if (!settings.expression->is_plain_signal()) {
        std::string const name = settings.label.empty() ? settings.expression->text() : settings.label;
        add(name, name, settings.expression->signals(), values_of(*settings.expression, signals, until_s));
        return out;
    }
    std::string const& pattern = settings.expression->signals().front();
    for (auto const& [signal, series] : signals) {
        auto const captured = captures(pattern, signal);
        if (!captured) {
            continue;
        }
        std::string const own = captured->empty() ? signal : join(*captured, " ");
        std::string const name = settings.label.empty() ? own : labelled(settings.label, *captured);
        if (is_no_delay(signal, series)) {
            not_measurable.push_back(own);
        } else { // "EV1" and "EV1 reference" are the same thing's; two lines without `*` are two things
            add(name, captured->empty() ? name : own, {signal}, series);
        }
    }
    return out;
}

std::vector<Figure::Shade> spans(Expression const& expression, SignalStore const& signals, double until_s) {
    std::vector<Figure::Shade> out;
    bool open = false;
    Timeline const timeline{expression, signals, 0, nanoseconds(until_s)};
    if (!timeline.missing().empty()) {
        return out;
    }
    timeline.run([&](std::int64_t t_ns, double value) {
        double const t = static_cast<double>(t_ns) / 1e9;
        bool const now = value != 0 && !std::isnan(value);
        if (now && !open) {
            out.push_back({t, until_s});
        } else if (!now && open) {
            out.back().to_s = t;
        }
        open = now;
        return true;
    });
    return out;
}

std::optional<double> first_true(Expression const& expression, SignalStore const& signals, double from_s,
                                 double until_s) {
    std::optional<double> out;
    Timeline const timeline{expression, signals, nanoseconds(from_s), nanoseconds(until_s)};
    if (timeline.missing().empty()) {
        timeline.run([&](std::int64_t t, double value) {
            if (value != 0 && !std::isnan(value)) {
                out = static_cast<double>(t) / 1e9;
            }
            return !out;
        });
    }
    return out;
}

std::int64_t as_place(double value) {
    constexpr double kFarthest = 9e9;
    return std::llround(std::clamp(value, -kFarthest, kFarthest) * 1e9);
}

std::optional<double> rises(SignalStore const& signals, std::string const& name, double from_s, double to_s) {
    auto const it = signals.find(name);
    for (std::size_t i = 0; it != signals.end() && i < it->second.values.size(); ++i) {
        double const t = static_cast<double>(it->second.times_ns[i]) / 1e9;
        if (t >= from_s && t <= to_s && it->second.values[i] != 0) {
            return t;
        }
    }
    return std::nullopt;
}

} // namespace gridspace::launcher
