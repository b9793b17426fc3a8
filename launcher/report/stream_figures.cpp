// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/stream_figures.hpp"

#include "common/text.hpp"
#include "launcher/report/series.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

/// Streams whose arrivals were measured.
std::vector<SmvTiming const*> measured(FigureSettings const& settings, WireTiming const& timing) {
    std::vector<SmvTiming const*> out;
    for (SmvTiming const& s : timing.smv) {
        if (matches_glob(settings.streams.name, s.stream) && s.arrival_ms.size() > 2) {
            out.push_back(&s);
        }
    }
    return out;
}

/// Samples in windows of 0.1 s: how many, over the time that their frames took.
Figure::Series rate_over_time(SmvTiming const& s) {
    Figure::Series out;
    out.name = s.stream;
    auto const per_frame = static_cast<double>(s.samples_per_frame);
    auto const per_window = static_cast<std::size_t>(std::max(2.0, s.nominal_hz.value_or(4800) / 10 / per_frame));
    for (std::size_t i = per_window; i < s.arrival_ms.size(); i += per_window) {
        out.times_ns.push_back(std::llround(s.arrival_ms[i] * 1e6));
        out.values.push_back(static_cast<double>(per_window) * per_frame /
                             (s.arrival_ms[i] - s.arrival_ms[i - per_window]) * 1e3);
    }
    return out;
}

Figure::Series interval_histogram(SmvTiming const& s, double bin_ms, double to_ms) {
    Figure::Series out;
    out.name = s.stream;
    std::vector<double> bins(static_cast<std::size_t>(std::ceil(to_ms / bin_ms)), 0);
    for (std::size_t i = 1; i < s.arrival_ms.size(); ++i) {
        double const interval = s.arrival_ms[i] - s.arrival_ms[i - 1];
        ++bins[std::min(bins.size() - 1, static_cast<std::size_t>(std::max(0.0, interval) / bin_ms))];
    }
    for (std::size_t i = 0; i < bins.size(); ++i) {
        out.times_ns.push_back(std::llround((static_cast<double>(i) + 0.5) * bin_ms * 1e9));
        out.values.push_back(bins[i]);
    }
    out.steps = true;
    return out;
}

std::string noted(std::string const& own, std::string method) {
    return own.empty() ? method : own + " " + method;
}

} // namespace

void message_intervals(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    constexpr int kBefore = 10, kAfter = 20; // messages around the event
    for (GooseTiming const& g : run.timing.goose) {
        if (!g.event || !matches_glob(settings.streams.name, g.stream)) {
            continue;
        }
        Figure f = empty_figure(settings, run);
        f.id += "_" + g.stream;
        f.title += ": " + g.stream;
        f.y_label = settings.label.empty() ? "interval, ms" : settings.label;
        f.axis = f.id;
        f.x_label = "message, counted from the first of the new state";
        f.from_s = -kBefore - 0.5;
        f.to_s = kAfter + 0.5;
        f.zero_s = 0;
        Figure::Series s{g.stream, {}, {}};
        s.points = true;
        for (int k = -kBefore; k <= kAfter; ++k) {
            auto const index = static_cast<std::int64_t>(*g.event) + k;
            if (index >= 1 && index < static_cast<std::int64_t>(g.interval_ms.size())) {
                s.times_ns.push_back(static_cast<std::int64_t>(k) * 1'000'000'000);
                s.values.push_back(g.interval_ms[static_cast<std::size_t>(index)]);
            }
        }
        f.series.push_back(std::move(s));
        f.marks = {{"event", 0, 1}};
        f.note =
            noted(settings.note, g.captured ? "Times of the capture between two messages: the sender is not ours. "
                                              "At the event a new state goes out."
                                            : "Sender's own times between two messages. At the event a new state "
                                              "goes out at once and is repeated after min_time, then ever later up "
                                              "to max_time.");
        out.push_back(std::move(f));
    }
}

void sample_rate(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    auto const streams = measured(settings, run.timing);
    if (streams.empty()) {
        return;
    }
    Figure f = empty_figure(settings, run);
    f.y_label = settings.label.empty() ? "samples per second" : settings.label;
    for (SmvTiming const* s : streams) {
        f.series.push_back(rate_over_time(*s));
    }
    if (streams.front()->nominal_hz) {
        f.lines.push_back({"nominal", *streams.front()->nominal_hz});
    }
    f.note = noted(settings.note, "As many samples at a time as a tenth of a second nominally has, over the time their "
                                  "frames took to arrive (kernel stamps at the relay).");
    out.push_back(std::move(f));
}

void frame_intervals(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    auto const streams = measured(settings, run.timing);
    if (streams.empty()) {
        return;
    }
    SmvTiming const& first = *streams.front();
    double const nominal_ms = 1e3 * static_cast<double>(first.samples_per_frame) / first.nominal_hz.value_or(4800);
    double const bin_ms = std::max(settings.bin > 0 ? settings.bin : 0.01, 5 * nominal_ms / kMostBins);
    Figure f = empty_figure(settings, run);
    f.y_label = settings.label.empty() ? fmt::format("frames in a bin of {:.4g} us", bin_ms * 1e3) : settings.label;
    f.axis = f.id;
    f.x_label = "interval, ms";
    f.log_y = true;
    f.from_s = f.zero_s = 0;
    f.to_s = 5 * nominal_ms;
    for (SmvTiming const* s : streams) {
        f.series.push_back(interval_histogram(*s, bin_ms, f.to_s));
    }
    f.marks = {{"nominal", nominal_ms, -1}};
    f.note =
        noted(settings.note, "Kernel stamps at the relay. Logarithmic: a single late frame is to be seen. The last "
                             "bin holds all that is longer.");
    out.push_back(std::move(f));
}

} // namespace gridspace::launcher
