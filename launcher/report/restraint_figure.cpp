// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/restraint_figure.hpp"

#include "agents/relay/relay_config.hpp"
#include "common/text.hpp"
#include "launcher/report/series.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Node;

relay::ElementParams element_of(Node const& process) {
    relay::RelayLogicConfig logic;
    config::Diagnostics other_keys; // and what is wrong was said before the run
    config::read_fields(process, "relay", other_keys, [&](config::Fields& f) { relay::describe(f, logic); });
    relay::ElementParams out;
    out.kind = logic.kind;
    out.pickup_a = logic.pickup_a;
    out.slope_percent = logic.slope_percent;
    out.slope2_percent = logic.slope2_percent;
    out.slope2_from_a = logic.slope2_from_a;
    return out;
}

Figure::Series characteristic(relay::ElementParams const& element, double to_a) {
    Figure::Series out{"characteristic", {}, {}};
    out.dashed = out.path = true;
    out.colour = 7;
    std::vector<double> corners{0, to_a};
    if (element.slope_percent > 0) {
        corners.push_back(element.pickup_a / element.slope_percent * 100);
    }
    if (element.slope2_percent > 0) {
        corners.push_back(element.slope2_from_a);
        // A first slope of nothing: the second one leaves the pickup later.
        corners.push_back(element.slope2_from_a +
                          (element.pickup_a - element.slope_percent / 100 * element.slope2_from_a) /
                              element.slope2_percent * 100);
    }
    std::sort(corners.begin(), corners.end());
    for (double const restraint_a : corners) {
        if (restraint_a >= 0 && restraint_a <= to_a) {
            out.times_ns.push_back(as_place(restraint_a));
            out.values.push_back(relay::operating_current_a(element, restraint_a));
        }
    }
    return out;
}

/// The states come with the latency of the relay, and say which sample they come from.
std::optional<double> decided_at(SignalStore const& signals, std::string const& prefix, char const* state,
                                 double from_s, double to_s) {
    auto const sample = signals.find(prefix + "sample_s");
    auto const at = rises(signals, prefix + state, from_s, to_s);
    if (!at || sample == signals.end()) {
        return at;
    }
    auto const after =
        std::upper_bound(sample->second.times_ns.begin(), sample->second.times_ns.end(), std::llround(*at * 1e9));
    return after == sample->second.times_ns.begin()
               ? at
               : std::optional{
                     sample->second.values[static_cast<std::size_t>(after - sample->second.times_ns.begin()) - 1]};
}

} // namespace

void restraint_planes(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    Node const* const processes = run.scenario.find("processes");
    SignalStore const& signals = run.results.signals;
    for (Node::Entry const& process : processes == nullptr ? std::vector<Node::Entry>{} : processes->entries) {
        std::string const prefix = "relay." + process.key + ".";
        if (!matches_glob(settings.streams.name, process.key) || !signals.contains(prefix + "restraint_a.a")) {
            continue;
        }
        Figure f = empty_plane(settings, run, process.key, "restraint current (mean of both ends), A",
                               "differential current, A");
        double const from_s = f.from_s, to_s = f.to_s, zero_s = f.zero_s;
        auto const pickup = decided_at(signals, prefix, "pickup", from_s, to_s);
        auto const trip = decided_at(signals, prefix, "trip", from_s, to_s);
        std::vector<std::pair<std::string, double>> named{{"", from_s}};
        if (pickup) {
            named.emplace_back(trip == pickup ? "pickup, trip" : "pickup", *pickup);
        }
        if (trip && trip != pickup) {
            named.emplace_back("trip", *trip);
        }
        double farthest = 0;
        for (std::size_t p = 0; p < 3; ++p) {
            std::string const phase(1, static_cast<char>('a' + p));
            auto const x = signals.find(prefix + "restraint_a." + phase),
                       y = signals.find(prefix + "differential_a." + phase);
            if (x == signals.end() || y == signals.end()) {
                continue;
            }
            Figure::Series path{"phase " + phase, {}, {}}, points;
            path.path = true;
            path.colour = static_cast<int>(p);
            std::vector<std::int64_t> instants;
            for (std::size_t i = 0; i < std::min(x->second.values.size(), y->second.values.size()); ++i) {
                double const t = static_cast<double>(x->second.times_ns[i]) / 1e9;
                bool const has_place = std::isfinite(x->second.values[i]) && std::isfinite(y->second.values[i]);
                if (has_place && t >= from_s && t <= to_s) {
                    instants.push_back(x->second.times_ns[i]);
                    path.times_ns.push_back(as_place(x->second.values[i]));
                    path.values.push_back(y->second.values[i]);
                    farthest = std::max(farthest, x->second.values[i]);
                }
            }
            if (path.values.empty()) {
                continue;
            }
            points = path;
            points.name.clear(); // it is in the legend already
            points.times_ns.clear();
            points.values.clear();
            points.points = true;
            points.connected = false;
            for (auto const& [name, at_s] : named) {
                auto const nearest = std::lower_bound(instants.begin(), instants.end(), std::llround(at_s * 1e9));
                auto const i = static_cast<std::size_t>(std::min(nearest, instants.end() - 1) - instants.begin());
                points.times_ns.push_back(path.times_ns[i]);
                points.values.push_back(path.values[i]);
                points.point_names.push_back(
                    p == 0 && !name.empty() ? fmt::format("{} ({:.4g} ms)", name, (at_s - zero_s) * 1e3) : "");
            }
            f.series.push_back(std::move(path));
            f.series.push_back(std::move(points));
        }
        if (f.series.empty()) {
            continue;
        }
        f.from_s = 0;
        f.to_s = 1.05 * std::max(farthest, 1e-9);
        f.series.insert(f.series.begin(), characteristic(element_of(process.value), f.to_s));
        f.zero_s = 0;
        f.zero_name.clear();
        f.note += f.note.empty() ? "" : " ";
        f.note += "The element picks up above the characteristic. A path begins at its dot and is that of a window of "
                  "samples, so it takes a whole window from before the fault to the fault.";
        out.push_back(std::move(f));
    }
}

} // namespace gridspace::launcher
