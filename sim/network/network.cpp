// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim {

LineTotals line_totals(Network const& network, Line const& line) {
    double const omega = 2 * std::numbers::pi * network.frequency_hz;
    LineTotals t;
    if (LineType const* type = find(network.line_types, line.type.name); type != nullptr) {
        double const km = line.length_km.value_or(0);
        t.r_ohm = type->r_ohm_per_km * km;
        t.l_h = type->l_mh_per_km ? *type->l_mh_per_km * 1e-3 * km : type->x_ohm_per_km.value_or(0) / omega * km;
        t.c_f = type->c_nf_per_km * 1e-9 * km;
        t.r0_ohm = type->r0_ohm_per_km ? *type->r0_ohm_per_km * km : t.r_ohm;
        t.l0_h = type->l0_mh_per_km    ? *type->l0_mh_per_km * 1e-3 * km
                 : type->x0_ohm_per_km ? *type->x0_ohm_per_km / omega * km
                                       : t.l_h;
        t.c0_f = type->c0_nf_per_km ? *type->c0_nf_per_km * 1e-9 * km : t.c_f;
        return t;
    }
    t.r_ohm = line.r_ohm.value_or(0);
    t.l_h = line.l_mh ? *line.l_mh * 1e-3 : line.x_ohm.value_or(0) / omega;
    t.c_f = line.c_nf.value_or(0) * 1e-9;
    t.r0_ohm = line.r0_ohm.value_or(t.r_ohm);
    t.l0_h = line.l0_mh ? *line.l0_mh * 1e-3 : line.x0_ohm ? *line.x0_ohm / omega : t.l_h;
    t.c0_f = line.c0_nf ? *line.c0_nf * 1e-9 : t.c_f;
    return t;
}

double profile_value(Profile const& p, double hours_since_start, double start_hour_of_day) {
    double const hours = p.time == Profile::Time::hour_of_day ? std::fmod(start_hour_of_day + hours_since_start, 24.0)
                                                              : hours_since_start;
    double value = 1;
    if (p.half_sine) {
        double const x = (hours - p.half_sine->rise_h) / (p.half_sine->set_h - p.half_sine->rise_h);
        value = x <= 0 || x >= 1 ? 0 : std::pow(std::sin(std::numbers::pi * x), p.half_sine->exponent);
    } else if (!p.hours.empty()) {
        auto const next = std::upper_bound(p.hours.begin(), p.hours.end(), hours);
        if (next == p.hours.begin()) {
            value = p.values.front();
        } else if (next == p.hours.end()) {
            value = p.values.back();
        } else {
            auto const i = static_cast<std::size_t>(next - p.hours.begin());
            double const share = (hours - p.hours[i - 1]) / (p.hours[i] - p.hours[i - 1]);
            value = p.values[i - 1] + share * (p.values[i] - p.values[i - 1]);
        }
    }
    for (Profile::Cloud const& cloud : p.clouds) {
        double const x = (hours - cloud.at_h) / cloud.width_h;
        value *= 1 - cloud.depth_percent / 100 * std::exp(-x * x);
    }
    return value;
}

Scale scale_of(Network const& network, Ref const& name, double start_hour_of_day) {
    Profile const* profile = name.empty() ? nullptr : find(network.profiles, name.name);
    if (profile == nullptr) {
        return [](double) { return 1.0; };
    }
    return [profile = *profile, start_hour_of_day](double t_s) {
        return profile_value(profile, t_s / 3600, start_hour_of_day);
    };
}

} // namespace gridspace::sim
