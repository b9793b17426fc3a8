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

/// Instants that are named on each path: its begin, without a name, then what the relay decided.
using NamedInstants = std::vector<std::pair<std::string, double>>;

NamedInstants named_instants(SignalStore const& signals, std::string const& prefix, double from_s, double to_s) {
    auto const pickup = decided_at(signals, prefix, "pickup", from_s, to_s);
    auto const trip = decided_at(signals, prefix, "trip", from_s, to_s);
    NamedInstants named{{"", from_s}};
    if (pickup) {
        named.emplace_back(trip == pickup ? "pickup, trip" : "pickup", *pickup);
    }
    if (trip && trip != pickup) {
        named.emplace_back("trip", *trip);
    }
    return named;
}

/// Where a phase goes in the plane, and when it is there.
struct PhasePath {
    Figure::Series line;
    std::vector<std::int64_t> instants; ///< of its points, ns
    double farthest_a{0};               ///< its largest restraint current
};

PhasePath phase_path(SignalSeries const& restraint, SignalSeries const& differential, std::size_t phase, double from_s,
                     double to_s) {
    PhasePath out{{fmt::format("phase {}", static_cast<char>('a' + phase)), {}, {}}, {}};
    out.line.path = true;
    out.line.colour = static_cast<int>(phase);
    for (std::size_t i = 0; i < std::min(restraint.values.size(), differential.values.size()); ++i) {
        double const t = static_cast<double>(restraint.times_ns[i]) / 1e9;
        bool const has_place = std::isfinite(restraint.values[i]) && std::isfinite(differential.values[i]);
        if (has_place && t >= from_s && t <= to_s) {
            out.instants.push_back(restraint.times_ns[i]);
            out.line.times_ns.push_back(as_place(restraint.values[i]));
            out.line.values.push_back(differential.values[i]);
            out.farthest_a = std::max(out.farthest_a, restraint.values[i]);
        }
    }
    return out;
}

/// Dots on a path. `with_names`: with what was decided there, and how long after `zero_s`.
Figure::Series dots_on(PhasePath const& path, NamedInstants const& named, double zero_s, bool with_names) {
    Figure::Series points = path.line;
    points.name.clear(); // it is in the legend already
    points.times_ns.clear();
    points.values.clear();
    points.points = true;
    points.connected = false;
    for (auto const& [name, at_s] : named) {
        auto const nearest = std::lower_bound(path.instants.begin(), path.instants.end(), std::llround(at_s * 1e9));
        auto const i = static_cast<std::size_t>(std::min(nearest, path.instants.end() - 1) - path.instants.begin());
        points.times_ns.push_back(path.line.times_ns[i]);
        points.values.push_back(path.line.values[i]);
        points.point_names.push_back(
            with_names && !name.empty() ? fmt::format("{} ({:.4g} ms)", name, (at_s - zero_s) * 1e3) : "");
    }
    return points;
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
        auto const named = named_instants(signals, prefix, f.from_s, f.to_s);
        double farthest = 0;
        for (std::size_t p = 0; p < 3; ++p) {
            std::string const phase(1, static_cast<char>('a' + p));
            auto const x = signals.find(prefix + "restraint_a." + phase),
                       y = signals.find(prefix + "differential_a." + phase);
            if (x == signals.end() || y == signals.end()) {
                continue;
            }
            PhasePath path = phase_path(x->second, y->second, p, f.from_s, f.to_s);
            if (path.instants.empty()) {
                continue;
            }
            farthest = std::max(farthest, path.farthest_a);
            Figure::Series dots = dots_on(path, named, f.zero_s, p == 0);
            f.series.push_back(std::move(path.line));
            f.series.push_back(std::move(dots));
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
