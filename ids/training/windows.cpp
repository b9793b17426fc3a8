// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/training/windows.hpp"

#include "common/random.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::ids {
namespace {

/// A window ends before sample `at` of one end (and phase) of a recording.
struct Place {
    std::uint32_t recording{0}, at{0};
    std::uint8_t end{0}, phase{0};
};

bool append(Windows& out, LineWaveform const& w, Place const& place, WindowParams const& p) {
    std::vector<Abc> const& samples = place.end == 0 ? w.from : w.to;
    std::size_t const x0 = out.x.size(), y0 = out.y.size(), window = static_cast<std::size_t>(p.window);
    double scale = p.scale_a;
    for (std::size_t c = 0; c < static_cast<std::size_t>(p.channels); ++c) {
        std::size_t const phase = p.channels == 1 ? place.phase : c;
        for (std::size_t k = 0; k < window; ++k) {
            double const v = samples[place.at - window + k][phase];
            out.x.push_back(v);
            if (p.scale == Model::Scale::window_peak) {
                scale = std::max(scale, std::fabs(v));
            }
        }
        out.y.push_back(samples[place.at][phase]);
    }
    bool finite = std::isfinite(scale);
    for (std::size_t k = x0; k < out.x.size(); ++k) {
        out.x[k] /= scale;
        finite = finite && std::isfinite(out.x[k]);
    }
    for (std::size_t k = y0; k < out.y.size(); ++k) {
        out.y[k] /= scale;
        finite = finite && std::isfinite(out.y[k]);
    }
    if (!finite) {
        out.x.resize(x0);
        out.y.resize(y0);
    }
    return finite;
}

} // namespace

Windows draw_windows(std::span<LineWaveform const> recordings, WindowParams const& p, std::uint64_t seed) {
    std::vector<Place> steady, events;
    for (std::size_t r = 0; r < recordings.size(); ++r) {
        LineWaveform const& w = recordings[r];
        auto const cycle = static_cast<std::int64_t>(std::lround(w.rate_hz / w.frequency_hz));
        for (std::uint8_t end = 0; end < (w.to.empty() ? 1 : 2); ++end) {
            for (std::size_t at = static_cast<std::size_t>(p.window); at < w.size(); ++at) {
                auto const k = static_cast<std::int64_t>(at);
                bool const eventful = w.event >= 0 && k >= w.event && k < w.event + cycle;
                for (std::uint8_t phase = 0; phase < (p.channels == 1 ? 3 : 1); ++phase) {
                    (eventful ? events : steady)
                        .push_back({static_cast<std::uint32_t>(r), static_cast<std::uint32_t>(at), end, phase});
                }
            }
        }
    }
    Random random{seed, "windows"};
    auto shuffle = [&](std::vector<Place>& v, std::size_t count) { // the first `count` of a random order
        count = std::min(count, v.size());
        for (std::size_t k = 0; k < count; ++k) {
            std::swap(v[k], v[k + random.below(v.size() - k)]);
        }
        v.resize(count);
    };
    shuffle(events, static_cast<std::size_t>(static_cast<double>(p.count) * p.event_share));
    shuffle(steady, p.count - std::min(p.count, events.size()));
    std::vector<Place> all = steady;
    all.insert(all.end(), events.begin(), events.end());
    shuffle(all, all.size());

    Windows out;
    out.inputs = static_cast<std::size_t>(p.window) * static_cast<std::size_t>(p.channels);
    out.outputs = static_cast<std::size_t>(p.channels);
    out.x.reserve(all.size() * out.inputs);
    out.y.reserve(all.size() * out.outputs);
    for (Place const& place : all) {
        append(out, recordings[place.recording], place, p);
    }
    return out;
}

} // namespace gridspace::ids
