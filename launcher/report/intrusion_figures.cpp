// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/intrusion_figures.hpp"

#include "common/text.hpp"
#include "launcher/ids/scatter.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::launcher {
namespace {

using Track = IntrusionRecording::Track;
using Label = IntrusionRecording::Label;

std::string percent(ids::Share const& s) {
    if (s.of == 0) {
        return "-";
    }
    return fmt::format("{:.3g} % ({} of {}; 95 %: {:.2g} to {:.2g} %)", s.percent, s.count, s.of, s.low_percent,
                       s.high_percent);
}

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

Figure waveform(IntrusionRecording const& recording, Track const& track, Label const& fake) {
    Figure f;
    f.id = "fake_" + track.detector + "_" + track.stream;
    auto const* at = sample_at(track, fake.index);
    f.title =
        fmt::format("A fake on {} phase {}: {:.2f} A instead of {:.2f} A; forecast {:.2f} A, accepted by {} {:.2f} A",
                    track.stream, "abc"[fake.channel], fake.sent_value, fake.true_value,
                    at->phases[fake.channel].forecast_a, track.detector, at->phases[fake.channel].accepted_a);
    f.y_label = "current, A";
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
    return f;
}

std::optional<Figure> trips(IntrusionScore::Relay const& r) {
    if (r.faults_s.empty()) {
        return std::nullopt;
    }
    Figure f;
    f.id = "trip_" + r.relay;
    f.title =
        fmt::format("Trip of {} on the fault of {}: with the detector, and the same relay without", r.relay, r.line);
    f.y_label = "trip";
    f.from_s = r.faults_s.front() - 0.005;
    f.to_s = r.faults_s.front() + 0.045;
    for (auto const& [name, list] : {std::pair{"with the detector", &r.trips}, {"without", &r.trips_without}}) {
        bool const with = list == &r.trips;
        double const high = with ? 1 : 0.9; // not one behind the other
        Figure::Series s{name, {std::llround(f.from_s * 1e9)}, {0}, true, !with, with ? 0 : 1};
        for (std::int64_t const trip : *list) {
            double const t = static_cast<double>(trip) / r.rate_hz;
            if (t <= f.from_s && with) { // sealed in since a false trip
                s.values.front() = high;
            } else if (t > f.from_s && t <= f.to_s && s.values.back() == 0) {
                s.times_ns.push_back(std::llround(t * 1e9));
                s.values.push_back(high);
            }
        }
        s.times_ns.push_back(std::llround(f.to_s * 1e9));
        s.values.push_back(s.values.back());
        f.series.push_back(std::move(s));
    }
    f.marks.push_back({"fault", r.faults_s.front()});
    return f;
}

std::string instants(std::vector<std::int64_t> const& trips, double rate_hz) {
    std::string out;
    for (std::size_t i = 0; i < trips.size() && i < 3; ++i) {
        out += fmt::format("{}{:.4f} s", i == 0 ? "" : ", ", static_cast<double>(trips[i]) / rate_hz);
    }
    return trips.empty() ? "none" : trips.size() > 3 ? fmt::format("{} … ({} in all)", out, trips.size()) : out;
}

} // namespace

std::vector<Figure> intrusion_figures(IntrusionScore const& score) {
    std::vector<Figure> out;
    for (Track const& track : score.recording.tracks) {
        if (Label const* fake = clearest(score.recording, track)) {
            out.push_back(waveform(score.recording, track, *fake));
        }
    }
    for (IntrusionScore::Relay const& r : score.relays) {
        if (auto figure = trips(r)) {
            out.push_back(std::move(*figure));
        }
    }
    return out;
}

std::vector<ReportTable> intrusion_tables(IntrusionScore const& score) {
    std::vector<ReportTable> out;
    if (!score.streams.empty()) {
        ReportTable t{"Detectors: verdicts against the truth (phase-samples)",
                      {"detector", "stream", "forged, flagged", "forged, not flagged", "genuine, flagged",
                       "genuine, not flagged", "false positives", "open loop", "samples of three phases with one",
                       "open loop"},
                      {}};
        for (IntrusionScore::Stream const& s : score.streams) {
            t.rows.push_back({escape_markup(s.detector), escape_markup(s.stream),
                              std::to_string(s.score.true_positives), std::to_string(s.score.false_negatives),
                              std::to_string(s.score.false_positives), std::to_string(s.score.true_negatives),
                              percent(s.score.false_positive), percent(s.score.open_false_positive), percent(s.packets),
                              percent(s.open_packets)});
        }
        out.push_back(std::move(t));
    }
    if (!score.attacks.empty() || !score.unjudged.empty()) {
        ReportTable t{"Attacks",
                      {"attack", "kind", "target", "detector", "altered", "detected",
                       "of those beyond twice the threshold", "open loop", "delay"},
                      {}};
        for (IntrusionScore::Attack const& a : score.attacks) {
            t.rows.push_back({escape_markup(a.score.attack), escape_markup(a.kind), escape_markup(a.target),
                              escape_markup(a.detector), std::to_string(a.score.labels), percent(a.score.detected),
                              percent(a.score.clear_detected), percent(a.score.open_detected),
                              a.score.seen ? fmt::format("{} samples ({:.2f} ms)", a.score.delay_samples,
                                                         static_cast<double>(a.score.delay_samples) / a.rate_hz * 1e3)
                                           : "never seen"});
        }
        for (IntrusionScore::Unjudged const& u : score.unjudged) {
            t.rows.push_back({escape_markup(u.attack), escape_markup(u.kind), escape_markup(u.target),
                              "nobody watches it", std::to_string(u.labels), "-", "-", "-", "-"});
        }
        out.push_back(std::move(t));
    }
    if (!score.relays.empty()) {
        ReportTable t{"Relays with a detector: trips against the faults that really were",
                      {"relay", "line", "faults", "tripped", "blocked or late", "false trips", "trips",
                       "the same relay without a detector", "added by the detector", "alarms (false)"},
                      {}};
        for (IntrusionScore::Relay const& r : score.relays) {
            std::string faults;
            for (double const at : r.faults_s) {
                faults += (faults.empty() ? "" : ", ") + shortest(at) + " s";
            }
            t.rows.push_back({escape_markup(r.relay), escape_markup(r.line), faults.empty() ? "none" : faults,
                              std::to_string(r.with.tripped), std::to_string(r.with.late_or_blocked),
                              std::to_string(r.with.false_trips), instants(r.trips, r.rate_hz),
                              instants(r.trips_without, r.rate_hz),
                              r.added_ms ? fmt::format("{:.2f} ms", *r.added_ms) : "-",
                              fmt::format("{} ({})", r.alarms, r.false_alarms)});
        }
        out.push_back(std::move(t));
    }
    return out;
}

std::vector<RocPoint> roc_of(IntrusionRecording const& recording, Track const& track) {
    std::set<std::pair<std::int64_t, std::uint8_t>> forged;
    for (Label const& l : recording.labels) {
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

std::vector<Drawing> intrusion_drawings(IntrusionScore const& score) {
    std::vector<Drawing> out;
    for (Track const& track : score.recording.tracks) {
        std::vector<RocPoint> const roc = roc_of(score.recording, track);
        if (roc.empty()) {
            continue;
        }
        cli::Scatter plot;
        plot.title =
            fmt::format("{} on {}: threshold from 0.1 to 40 times the one used (x1)", track.detector, track.stream);
        plot.x_label = "false positives, % of genuine phase-samples (open loop)";
        plot.y_label = "detected, % of forged phase-samples";
        plot.x_log = true;
        plot.connect = true;
        for (std::size_t i = 0; i < roc.size(); ++i) {
            bool const named = i % 5 == 0;
            plot.points.push_back({std::max(roc[i].false_positive_percent, 1e-3), roc[i].detected_percent,
                                   named ? fmt::format("x{:.3g}", roc[i].threshold) : "", 0});
        }
        out.push_back({"roc_" + track.detector + "_" + track.stream, plot.title, cli::to_svg(plot)});
    }
    return out;
}

} // namespace gridspace::launcher
