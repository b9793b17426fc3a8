// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/time_current_figure.hpp"

#include "agents/relay/functions/overcurrent.hpp"
#include "launcher/report/bay_functions.hpp"
#include "launcher/report/series.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr double kSoonestS = 1e-3; // below it a logarithmic axis ends

/// Published currents of a function, by phase or the one that there is.
std::vector<SignalSeries const*> currents_in(SignalStore const& signals, std::string const& function) {
    std::vector<SignalSeries const*> out;
    for (char const* phase : {"", ".a", ".b", ".c"}) {
        if (auto const it = signals.find(function + ".current_a" + phase); it != signals.end()) {
            out.push_back(&it->second);
        }
    }
    return out;
}

/// The largest of them at an instant; A.
double current_at(std::vector<SignalSeries const*> const& currents, double at_s) {
    double out = 0;
    for (SignalSeries const* series : currents) {
        auto const after = std::upper_bound(series->times_ns.begin(), series->times_ns.end(), std::llround(at_s * 1e9));
        double const value = after == series->times_ns.begin()
                                 ? 0
                                 : series->values[static_cast<std::size_t>(after - series->times_ns.begin()) - 1];
        out = std::isfinite(value) ? std::max(out, value) : out;
    }
    return out;
}

/// Operate time of a function at a current, s; infinite below its pickup.
double time_at(relay::NamedFunction const& f, double current_a) {
    if (f.of == relay::NodeClass::pioc) {
        relay::PiocParams const& p = static_cast<relay::Pioc const&>(*f.function).params();
        return current_a > p.pickup_a ? kSoonestS : INFINITY;
    }
    relay::PtocParams const& p = static_cast<relay::Ptoc const&>(*f.function).params();
    if (!(current_a > p.pickup_a)) {
        return INFINITY;
    }
    return p.curve == relay::Curve::definite_time
               ? std::max(p.delay_s, kSoonestS)
               : std::max(p.time_multiplier * relay::operate_time_s(p.curve, current_a / p.pickup_a), p.minimum_s);
}

double pickup_of(relay::NamedFunction const& f) {
    return f.of == relay::NodeClass::pioc ? static_cast<relay::Pioc const&>(*f.function).params().pickup_a
                                          : static_cast<relay::Ptoc const&>(*f.function).params().pickup_a;
}

struct Curved {
    std::string name; ///< relay and function
    relay::NamedFunction const* function{nullptr};
    std::vector<SignalSeries const*> currents;
    std::optional<FunctionCourse> course;
};

/// From the pickup to `to_a`, upwards out of the picture at its begin.
Figure::Series curve(Curved const& one, int colour, double to_a, double longest_s) {
    Figure::Series out{one.name, {}, {}};
    out.path = true;
    out.colour = colour;
    double const pickup_a = pickup_of(*one.function);
    auto const add = [&](double current_a, double time_s) {
        out.times_ns.push_back(as_place(std::log10(current_a)));
        out.values.push_back(time_s);
    };
    add(pickup_a, 10 * longest_s);
    constexpr int kPoints = 200;
    for (int k = 0; k <= kPoints && to_a > pickup_a; ++k) {
        double const current_a = pickup_a * std::pow(to_a / pickup_a, std::max<double>(k, 0.01) / kPoints);
        double const time_s = time_at(*one.function, current_a);
        if (time_s < 10 * longest_s) {
            add(current_a, time_s);
        }
    }
    return out;
}

/// The point at which it operated, or up to which it had come when it fell back or the window ended.
Figure::Series point(Curved const& one, int colour, double end_s, std::string& said) {
    Figure::Series out{"", {}, {}};
    out.points = out.path = true;
    out.connected = false;
    out.colour = colour;
    if (!one.course) {
        said += fmt::format(" {} did not start.", one.name);
        return out;
    }
    auto const& operate = one.course->operate_s;
    double const until_s = operate ? *operate : std::min(one.course->drop_s.value_or(end_s), end_s);
    double current_a = current_at(one.currents, until_s);
    if (!operate) { // when it falls back, the current has gone: the largest before
        for (SignalSeries const* series : one.currents) {
            for (std::size_t i = 0; i < series->values.size(); ++i) {
                double const t = static_cast<double>(series->times_ns[i]) / 1e9;
                bool const counts = t >= one.course->start_s && t <= until_s && std::isfinite(series->values[i]);
                current_a = counts ? std::max(current_a, series->values[i]) : current_a;
            }
        }
    }
    double const time_s = std::max(until_s - one.course->start_s, kSoonestS);
    out.times_ns.push_back(as_place(std::log10(std::max(current_a, 1e-9))));
    out.values.push_back(time_s);
    out.point_names.push_back(one.name + (operate ? " operates" : " starts only"));
    double const wanted_s = time_at(*one.function, current_a);
    said += operate ? fmt::format(" {} operates {:.4g} s after its start, at {:.4g} A (its curve: {:.4g} s).", one.name,
                                  until_s - one.course->start_s, current_a, wanted_s)
                    : fmt::format(" {} is started for {:.4g} s with up to {:.4g} A, and would need {:.4g} s.", one.name,
                                  until_s - one.course->start_s, current_a, wanted_s);
    return out;
}

} // namespace

void time_current_curves(FigureSettings const& settings, Drawn const& run, std::vector<Figure>& out) {
    std::vector<BayFunctions> const relays = bay_functions(run.scenario, settings.streams.name);
    Figure f = empty_plane(settings, run, "", "current, A (primary)", "time, s");
    double const from_s = f.from_s, to_s = f.to_s;
    std::vector<Curved> all;
    double least_a = INFINITY, most_a = 0;
    for (BayFunctions const& relay : relays) {
        for (relay::NamedFunction const& function : relay.functions.functions()) {
            auto currents = currents_in(run.results.signals, "relay." + relay.relay + "." + function.name);
            if ((function.of != relay::NodeClass::ptoc && function.of != relay::NodeClass::pioc) || currents.empty()) {
                continue;
            }
            least_a = std::min(least_a, pickup_of(function));
            most_a = std::max(most_a, pickup_of(function));
            all.push_back({relay.relay + " " + function.name, &function, std::move(currents),
                           course_of(run.results.signals, relay.relay, function.name, from_s, to_s)});
        }
    }
    if (all.empty()) {
        return;
    }
    std::vector<Figure::Series> points;
    std::string said;
    double soonest_s = INFINITY, latest_s = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
        points.push_back(point(all[k], static_cast<int>(k), to_s, said));
        for (std::size_t i = 0; i < points[k].values.size(); ++i) {
            double const current_a = std::pow(10, static_cast<double>(points[k].times_ns[i]) / 1e9);
            most_a = std::max(most_a, current_a);
            soonest_s = std::min(soonest_s, points[k].values[i]);
            latest_s = std::max(latest_s, points[k].values[i]);
        }
    }
    most_a *= 2;
    for (Curved const& one : all) {
        soonest_s = std::min(soonest_s, time_at(*one.function, most_a));
        double const at_double_s = time_at(*one.function, 2 * pickup_of(*one.function));
        latest_s = std::isfinite(at_double_s) ? std::max(latest_s, at_double_s) : latest_s;
    }
    latest_s *= 3;
    for (std::size_t k = 0; k < all.size(); ++k) {
        f.series.push_back(curve(all[k], static_cast<int>(k), most_a, latest_s));
    }
    std::ranges::move(points, std::back_inserter(f.series));
    f.log_x = f.log_y = true;
    f.from_s = std::log10(0.7 * least_a);
    f.to_s = std::log10(most_a);
    f.y_range = {std::log10(std::max(soonest_s / 2, kSoonestS / 2)), std::log10(latest_s)};
    f.zero_s = 0;
    f.zero_name.clear();
    f.plot_height = 360;
    f.note += (f.note.empty() ? "" : " ") +
              std::string{"A dot is at the current of that moment and the time since the function's "
                          "own start; the time of a curve is integrated over the current."} +
              said;
    out.push_back(std::move(f));
}

} // namespace gridspace::launcher
