// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/ride_through.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {

using namespace elements;

namespace {

constexpr double kNominalHz = 60; ///< of the standard's tables

/// Of a category: clearing time of an element by its default threshold.
struct Default {
    double at, after_s;
};
struct Defaults {
    Default ov2, ov1, uv1, uv2;
    double cease_below, cease_above;
};
/// Tables 11 to 13 (trips); 14 to 16: below and above these it ceases to energise at once.
Defaults defaults(RideThrough::Category category) {
    switch (category) {
    case RideThrough::Category::one:
        return {{1.20, 0.16}, {1.10, 2}, {0.70, 2}, {0.45, 0.16}, 0.50, 1.20};
    case RideThrough::Category::two:
        return {{1.20, 0.16}, {1.10, 2}, {0.70, 10}, {0.45, 0.16}, 0.30, 1.20};
    case RideThrough::Category::three:
        break;
    }
    return {{1.20, 0.16}, {1.10, 13}, {0.88, 21}, {0.50, 2}, 0.50, 1.10};
}
/// Table 18, p.u. of nominal.
constexpr Default kOf2{62.0 / kNominalHz, 0.16}, kOf1{61.2 / kNominalHz, 300}, kUf1{58.5 / kNominalHz, 300},
    kUf2{56.5 / kNominalHz, 0.16};
/// Table 4.
constexpr double kFitMinPu = 0.917, kFitMaxPu = 1.05, kFitMin = 59.5 / kNominalHz, kFitMax = 60.1 / kNominalHz;

void describe_trip(Fields& f, std::string_view key, std::string_view doc, std::string_view at_key,
                   RideThrough::Trip& trip) {
    f.object(key, {.doc = doc}, [&](Fields& t) {
        double at = 0, after = 0;
        t.number(at_key, at, positive("threshold"));
        t.number("after_s", after, positive("clearing time"));
        if (at > 0) {
            trip.at = at;
        }
        if (after > 0) {
            trip.after_s = after;
        }
    });
}

void optional_number(Fields& f, std::string_view key, std::optional<double>& out, std::string_view doc) {
    double value = 0;
    f.number(key, value, positive(doc));
    if (value > 0) {
        out = value;
    }
}

} // namespace

double FrequencyShift::lead_rad(double off_nominal_hz) const {
    constexpr double kMost = 0.5; // 45 degrees: beyond, the voltage goes before the frequency
    return std::numbers::pi / 2 * std::clamp(chopping_pu + gain_per_hz * off_nominal_hz, -kMost, kMost);
}

void FrequencyShift::fields(Fields& f) {
    NumberSpec chopping = not_negative("chopping fraction at nominal frequency");
    chopping.below = 0.5;
    f.number("chopping_pu", chopping_pu, chopping);
    f.number("gain_per_hz", gain_per_hz, not_negative("what is added to it for each Hz above nominal"));
}

void RideThrough::fields(Fields& f) {
    f.choice<Category>("category", category, {{"I", Category::one}, {"II", Category::two}, {"III", Category::three}},
                       {.doc = "abnormal operating performance category"});
    f.object("trip", {.doc = "settings instead of the defaults of the category"}, [&](Fields& t) {
        describe_trip(t, "ov2", "higher overvoltage", "voltage_pu", ov2);
        describe_trip(t, "ov1", "lower overvoltage", "voltage_pu", ov1);
        describe_trip(t, "uv1", "higher undervoltage", "voltage_pu", uv1);
        describe_trip(t, "uv2", "lower undervoltage", "voltage_pu", uv2);
        describe_trip(t, "of2", "higher overfrequency", "frequency_hz", of2);
        describe_trip(t, "of1", "lower overfrequency", "frequency_hz", of1);
        describe_trip(t, "uf1", "higher underfrequency", "frequency_hz", uf1);
        describe_trip(t, "uf2", "lower underfrequency", "frequency_hz", uf2);
    });
    f.object("cease", {.doc = "momentary cessation: no current while the voltage is so"}, [&](Fields& c) {
        optional_number(c, "below_pu", cease_below_pu, "voltage");
        optional_number(c, "above_pu", cease_above_pu, "voltage");
    });
    f.number("restore_s", restore_s, positive("ramp of the current after a momentary cessation"));
    f.object("enter_service", {.doc = "return after a trip"}, [&](Fields& e) {
        e.number("delay_s", delay_s, not_negative("for so long the grid must be fit"));
        e.number("ramp_s", ramp_s, positive("ramp of the current"));
        optional_number(e, "voltage_min_pu", fit_min_pu, "of a fit grid");
        optional_number(e, "voltage_max_pu", fit_max_pu, "of a fit grid");
        optional_number(e, "frequency_min_hz", fit_min_hz, "of a fit grid");
        optional_number(e, "frequency_max_hz", fit_max_hz, "of a fit grid");
    });
    f.object("anti_islanding", {.doc = "Sandia frequency shift: without a grid the frequency runs away"},
             [&](Fields& a) { shift.emplace().fields(a); });
    Defaults const d = defaults(category);
    auto const ordered = [&](std::string_view lower, std::optional<double> low, std::string_view higher,
                             std::optional<double> high) {
        if (low && high && *low > *high) {
            f.error("", fmt::format("{} ({:.4g}) is above {} ({:.4g})", lower, *low, higher, *high),
                    "uv2 <= uv1 < ov1 <= ov2, uf2 <= uf1 < of1 <= of2");
        }
    };
    double const uv1_pu = uv1.at.value_or(d.uv1.at), ov1_pu = ov1.at.value_or(d.ov1.at);
    ordered("uv2", uv2.at.value_or(d.uv2.at), "uv1", uv1_pu);
    ordered("uv1", uv1_pu, "ov1", ov1_pu);
    ordered("ov1", ov1_pu, "ov2", ov2.at.value_or(d.ov2.at));
    ordered("uf2", uf2.at, "uf1", uf1.at); // the defaults go with the nominal frequency, which is not known here
    ordered("uf1", uf1.at, "of1", of1.at);
    ordered("of1", of1.at, "of2", of2.at);
    ordered("voltage_min_pu", fit_min_pu, "voltage_max_pu", fit_max_pu);
    ordered("frequency_min_hz", fit_min_hz, "frequency_max_hz", fit_max_hz);
}

GridRules RideThrough::rules(double nominal_hz) const {
    Defaults const d = defaults(category);
    GridRules out;
    auto const voltage = [&](Trip const& set, Default const& usual, double GridWindow::* bound) {
        GridWindow w;
        w.*bound = set.at.value_or(usual.at);
        out.trips.push_back({w, set.after_s.value_or(usual.after_s)});
    };
    auto const frequency = [&](Trip const& set, Default const& usual, double GridWindow::* bound) {
        GridWindow w;
        w.*bound = (set.at ? *set.at / nominal_hz : usual.at) - 1;
        out.trips.push_back({w, set.after_s.value_or(usual.after_s)});
    };
    voltage(ov2, d.ov2, &GridWindow::v_high);
    voltage(ov1, d.ov1, &GridWindow::v_high);
    voltage(uv1, d.uv1, &GridWindow::v_low);
    voltage(uv2, d.uv2, &GridWindow::v_low);
    frequency(of2, kOf2, &GridWindow::f_high);
    frequency(of1, kOf1, &GridWindow::f_high);
    frequency(uf1, kUf1, &GridWindow::f_low);
    frequency(uf2, kUf2, &GridWindow::f_low);
    out.momentary = GridWindow{cease_below_pu.value_or(d.cease_below), cease_above_pu.value_or(d.cease_above)};
    out.restore_s = restore_s;
    auto const share = [&](std::optional<double> const& hz, double usual) {
        return (hz ? *hz / nominal_hz : usual) - 1;
    };
    out.fit = {fit_min_pu.value_or(kFitMinPu), fit_max_pu.value_or(kFitMaxPu), share(fit_min_hz, kFitMin),
               share(fit_max_hz, kFitMax)};
    out.fit_s = delay_s;
    out.ramp_s = ramp_s;
    out.shift = shift;
    return out;
}

GridRules GridRules::usual() {
    GridRules out;
    out.trips = {{{0.5, 1.2, -0.1, 0.1}, 0.16}};
    out.fit = {0.88, 1.1, -0.01, 0.01};
    return out;
}

GridRules GridRules::of_load() {
    GridRules out;
    out.trips = {{{0.3, 1.2, -0.1, 0.1}, 0.16}};
    out.fit = {0.8, 1.2, -0.05, 0.05};
    out.fit_s = 0;
    out.ramp_s = 1e-3;
    return out;
}

void describe_ride_through(Fields& f, std::optional<RideThrough>& out) {
    f.object("ride_through", {.doc = "categories of IEEE 1547-2018: when it trips, ceases and comes back"},
             [&](Fields& r) { out.emplace().fields(r); });
}

} // namespace gridspace::sim
