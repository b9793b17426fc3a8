// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/detector_figures.hpp"

#include "common/text.hpp"
#include "launcher/judge/detector_roc.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::launcher {
namespace {

using Track = IntrusionRecording::Track;
using Label = IntrusionRecording::Label;

IntrusionRecording::Sample const* sample_at(Track const& track, std::int64_t index) {
    auto const it = std::lower_bound(track.samples.begin(), track.samples.end(), index,
                                     [](auto const& s, std::int64_t i) { return s.index < i; });
    return it == track.samples.end() || it->index != index ? nullptr : &*it;
}

/// The fake that is farthest from the truth and stands alone for a cycle; otherwise the farthest.
Label const* clearest(IntrusionRecording const& recording, Track const& track) {
    Label const *best = nullptr, *alone = nullptr;
    std::set<std::int64_t> forged;
    for (Label const& l : recording.labels) {
        if (l.target == track.stream) {
            forged.insert(l.index);
        }
    }
    auto const farther = [](Label const* a, Label const& b) {
        return a == nullptr || std::fabs(b.sent_value - b.true_value) > std::fabs(a->sent_value - a->true_value);
    };
    for (Label const& l : recording.labels) {
        auto const* sample = l.target == track.stream ? sample_at(track, l.index) : nullptr;
        if (sample == nullptr || l.channel > 2 || !sample->phases[l.channel].judged) {
            continue;
        }
        best = farther(best, l) ? &l : best;
        auto const at = forged.find(l.index);
        std::int64_t const gap = std::llround(track.rate_hz / 60);
        bool const is_alone = (at == forged.begin() || l.index - *std::prev(at) >= gap) &&
                              (std::next(at) == forged.end() || *std::next(at) - l.index >= gap);
        // A loop that is locked out would only show itself.
        auto const* before = sample_at(track, l.index - 1);
        bool const trusted = before == nullptr || !before->phases[l.channel].flagged;
        alone = is_alone && trusted && farther(alone, l) ? &l : alone;
    }
    return alone != nullptr ? alone : best;
}

Figure waveform(FigureSettings const& settings, Drawn const& run, Track const& track, Label const& fake) {
    IntrusionRecording const& recording = run.results.intrusion.recording;
    Figure f = empty_figure(settings, run);
    f.id += "_" + track.detector + "_" + track.stream;
    auto const* at = sample_at(track, fake.index);
    f.title += fmt::format(" on {} phase {}: {:.2f} A instead of {:.2f} A; forecast {:.2f} A, accepted by {} {:.2f} A",
                           track.stream, "abc"[fake.channel], fake.sent_value, fake.true_value,
                           at->phases[fake.channel].forecast_a, track.detector, at->phases[fake.channel].accepted_a);
    f.y_label = settings.label.empty() ? "current, A" : settings.label;
    std::int64_t const around = std::llround(track.rate_hz / 60 * 0.75);
    std::map<std::int64_t, double> truth;
    for (Label const& l : recording.labels) {
        if (l.target == track.stream && l.channel == fake.channel) {
            truth[l.index] = l.true_value;
        }
    }
    Figure::Series received{"received", {}, {}, false, false, 1}, forecast{"forecast", {}, {}, false, true, 0},
        accepted{"accepted", {}, {}, false, false, 2}, real{"true", {}, {}, false, true, 5};
    for (auto const& s : track.samples) {
        if (s.index < fake.index - around || s.index > fake.index + around) {
            continue;
        }
        auto const& p = s.phases[fake.channel];
        std::int64_t const t = std::llround(track.time_s(s) * 1e9);
        auto const known = truth.find(s.index);
        for (auto const& [series, value] : {std::pair{&received, double{p.raw_a}},
                                            {&forecast, double{p.forecast_a}},
                                            {&accepted, double{p.accepted_a}},
                                            {&real, known == truth.end() ? double{p.raw_a} : known->second}}) {
            series->times_ns.push_back(t);
            series->values.push_back(value);
        }
    }
    f.series = {std::move(received), std::move(forecast), std::move(accepted), std::move(real)};
    f.from_s = static_cast<double>(fake.index - around) / track.rate_hz;
    f.to_s = static_cast<double>(fake.index + around) / track.rate_hz;
    f.axis = f.id;
    return f;
}

std::optional<Figure> trips(FigureSettings const& settings, Drawn const& run, IntrusionScore::Relay const& r) {
    if (r.faults_s.empty()) {
        return std::nullopt;
    }
    Figure f = empty_figure(settings, run);
    f.id += "_" + r.relay;
    f.title += fmt::format(": {}, fault of {}", r.relay, r.line);
    f.lanes = true;
    f.from_s = r.faults_s.front() - 0.005;
    f.to_s = r.faults_s.front() + 0.045;
    for (auto const& [name, list] : {std::pair{"with the detector", &r.trips}, {"without it", &r.trips_without}}) {
        bool const with = list == &r.trips;
        Figure::Series s{name, {std::llround(f.from_s * 1e9)}, {0}, true, !with, with ? 0 : 1};
        for (std::int64_t const trip : *list) {
            double const t = static_cast<double>(trip) / r.rate_hz;
            if (t <= f.from_s && with) { // sealed in since a false trip
                s.values.front() = 1;
            } else if (t > f.from_s && t <= f.to_s && s.values.back() == 0) {
                s.times_ns.push_back(std::llround(t * 1e9));
                s.values.push_back(1);
            }
        }
        s.times_ns.push_back(std::llround(f.to_s * 1e9));
        s.values.push_back(s.values.back());
        f.series.push_back(std::move(s));
    }
    f.marks = {{"fault", r.faults_s.front()}};
    f.zero_s = r.faults_s.front();
    f.zero_name = "the fault";
    f.axis = f.id;
    return f;
}

} // namespace

void forged_samples(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    IntrusionRecording const& recording = run.results.intrusion.recording;
    for (Track const& track : recording.tracks) {
        Label const* fake = matches_glob(settings.streams.name, track.stream) ? clearest(recording, track) : nullptr;
        if (fake != nullptr) {
            out.push_back(waveform(settings, run, track, *fake));
        }
    }
}

void trip_comparisons(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    for (IntrusionScore::Relay const& r : run.results.intrusion.relays) {
        if (auto figure = matches_glob(settings.streams.name, r.relay) ? trips(settings, run, r) : std::nullopt) {
            out.push_back(std::move(*figure));
        }
    }
}

void roc_curves(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    constexpr double kMinPercent = 1e-3; // where "none at all" is drawn on a logarithmic axis
    for (Track const& track : run.results.intrusion.recording.tracks) {
        if (!matches_glob(settings.streams.name, track.stream)) {
            continue;
        }
        std::vector<RocPoint> roc = roc_of(run.results.intrusion.recording, track);
        if (roc.empty()) {
            continue;
        }
        std::reverse(roc.begin(), roc.end()); // false positives increase
        Figure f = empty_figure(settings, run);
        f.id += "_" + track.detector + "_" + track.stream;
        f.title +=
            fmt::format(": {} on {}, threshold from 0.1 to 40 times the one used (x1)", track.detector, track.stream);
        f.x_label = "false positives, % of genuine phase-samples (open loop)";
        f.y_label = settings.label.empty() ? "detected, % of forged phase-samples" : settings.label;
        f.log_x = true;
        f.axis = f.id;
        Figure::Series s{track.stream, {}, {}};
        s.points = true;
        for (std::size_t i = 0; i < roc.size(); ++i) {
            s.times_ns.push_back(std::llround(std::log10(std::max(roc[i].false_positive_percent, kMinPercent)) * 1e9));
            s.values.push_back(roc[i].detected_percent);
            s.point_names.push_back((roc.size() - 1 - i) % 5 == 0 ? fmt::format("x{:.3g}", roc[i].threshold) : "");
        }
        f.series.push_back(std::move(s));
        f.from_s = std::log10(kMinPercent) - 0.1;
        f.to_s = 2.1;
        out.push_back(std::move(f));
    }
}

} // namespace gridspace::launcher
