// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/intrusion_view.hpp"

#include "bus/codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <intrusion.h>
#include <limits>

namespace gridspace::monitor {
namespace {

constexpr std::size_t kRows = 65536;   ///< of samples: 13 s of 4800 Hz as they came, then lowest and highest
constexpr std::size_t kMaxTracks = 64; ///< detectors times streams
constexpr std::array kOfPhase{"raw", "forecast", "accepted", "limit", "flagged"};
constexpr std::array kFigures{
    "judged", "flagged_samples", "false_positives", "false_positive_percent", "open_loop_false_positive_percent",
    "fakes",  "detected",        "detected_percent"};

} // namespace

void IntrusionView::Track::tell(std::int64_t time_ns) {
    stream::IntrusionTally::Counts const& c = tally.counts();
    std::array<double, kFigures.size()> const row{static_cast<double>(c.judged),
                                                  static_cast<double>(c.flagged),
                                                  static_cast<double>(c.false_positives()),
                                                  c.false_positive_percent(),
                                                  c.open_loop_false_positive_percent(),
                                                  static_cast<double>(c.fakes),
                                                  static_cast<double>(c.detected),
                                                  c.detected_percent()};
    figures->append(figures->empty() ? time_ns : std::max(time_ns, figures->newest_ns() + 1), row);
}

bool IntrusionView::on_verdict(std::span<std::byte const> cdr, Signals& signals) {
    IdsVerdict sample;
    if (!bus::codec_of<IdsVerdict>().decode(cdr, &sample) || sample.rate_num() == 0) {
        return false;
    }
    std::pair<std::string, std::string> const key{sample.detector().c_str(), sample.stream().c_str()};
    if (!tracks_.contains(key) && tracks_.size() >= kMaxTracks) {
        return true;
    }
    Track& track = tracks_[key];
    if (track.samples == nullptr) {
        std::string const prefix = "ids." + key.first + "." + key.second + ".";
        std::vector<stream::SignalWindow::Column> columns, figures;
        for (char const* what : kOfPhase) {
            for (char const* phase : {"a", "b", "c"}) {
                columns.push_back({prefix + what + "." + phase, what == kOfPhase.back() ? "" : "A"});
            }
        }
        for (std::string const figure : kFigures) {
            figures.push_back({prefix + figure, figure.ends_with("_percent") ? "%" : ""});
        }
        auto const make = [&](char const* group, auto names, std::size_t rows) {
            auto& window = signals[{key.first, group + key.second}];
            window = std::make_unique<stream::SignalWindow>(std::move(names), rows);
            return window.get();
        };
        track.samples = make("verdicts of ", std::move(columns), kRows);
        track.figures = make("score of ", std::move(figures), kRows / 16);
    }
    double const period_ns = 1e9 * sample.rate_den() / sample.rate_num();
    std::uint64_t index = sample.first_index();
    for (SampleVerdict const& s : sample.samples()) {
        std::array<double, 3 * kOfPhase.size()> row{};
        stream::IntrusionTally::Phases said;
        for (std::size_t p = 0; p < 3; ++p) {
            PhaseVerdict const& v = p == 0 ? s.a() : p == 1 ? s.b() : s.c();
            bool const known = (v.flags() & VERDICT_JUDGED) != 0, bad = (v.flags() & VERDICT_FLAGGED) != 0;
            double const none = std::numeric_limits<double>::quiet_NaN();
            std::array<double, kOfPhase.size()> const values{v.raw_a(), known ? v.forecast_a() : none, v.accepted_a(),
                                                             known ? v.limit_a() : none, bad ? 1.0 : 0.0};
            for (std::size_t i = 0; i < values.size(); ++i) {
                row[3 * i + p] = values[i];
            }
            std::uint8_t const bit = static_cast<std::uint8_t>(1U << p), none_of_them = 0;
            said.judged |= known ? bit : none_of_them;
            said.flagged |= bad ? bit : none_of_them;
            said.open_flagged |= (v.flags() & VERDICT_OPEN_FLAGGED) != 0 ? bit : none_of_them;
        }
        track.samples->append(std::llround(static_cast<double>(index) * period_ns), row);
        track.tally.verdict(index, said);
        ++index;
    }
    track.tell(sample.time_ns());
    return true;
}

bool IntrusionView::on_label(std::span<std::byte const> cdr) {
    AttackLabel sample;
    if (!bus::codec_of<AttackLabel>().decode(cdr, &sample)) {
        return false;
    }
    for (auto& [key, track] : tracks_) {
        if (key.second == sample.target().c_str()) {
            for (LabelledValue const& value : sample.values()) {
                track.tally.label(value.index(), value.channel());
            }
            track.tell(sample.time_ns());
        }
    }
    return true;
}

} // namespace gridspace::monitor
