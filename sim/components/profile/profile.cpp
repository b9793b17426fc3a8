// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/profile/profile.hpp"

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/profile/profile_csv.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {

using namespace elements;

void Profile::fields(Fields& f) {
    f.choice<Time>("time", time, {{"since_start", Time::since_start}, {"hour_of_day", Time::hour_of_day}},
                   {.doc = "what the hours count from"});
    f.numbers("hours", hours, any("times of the points, increasing"));
    f.numbers("values", values, any("values at the points; linear between them"));
    std::filesystem::path csv;
    std::string column;
    f.file("csv", csv, {.doc = "file with a column hours (or h, time_h) and others, instead of points"});
    f.text("column", column, {.doc = "column of the file"});
    f.object("half_sine", {.doc = "sin(pi (h - rise) / (set - rise)) ^ exponent by day, else 0"}, [&](Fields& h) {
        Profile::HalfSine& sine = half_sine.emplace();
        h.number("rise_h", sine.rise_h, any("sunrise", true));
        h.number("set_h", sine.set_h, any("sunset", true));
        h.number("exponent", sine.exponent, positive("1: a sine"));
        if (sine.set_h <= sine.rise_h) {
            h.error("set_h", "the sun sets before it rises");
        }
    });
    f.list("clouds", {.doc = "dips: times (1 - depth exp(-((h - at) / width)^2))"}, [&](Fields& c) {
        Profile::Cloud cloud;
        c.number("at_h", cloud.at_h, any("middle", true));
        c.number("depth_percent", cloud.depth_percent, percent("depth", true));
        c.number("width_h", cloud.width_h, positive("width", true));
        clouds.push_back(cloud);
    });
    if (!csv.empty()) {
        if (auto read = read_profile_csv(csv, column); read) {
            hours = std::move(read->hours);
            values = std::move(read->values);
        } else {
            f.error("csv", read.error().message, read.error().remedy);
        }
    }
    int const kinds = (f.has("csv") ? 1 : hours.empty() ? 0 : 1) + (half_sine ? 1 : 0);
    if (kinds != 1 || (f.has("csv") && f.has("hours"))) {
        f.error("", fmt::format("profile '{}' needs points (hours and values), a csv, or a half_sine", name.name));
    }
    if (hours.size() != values.size()) {
        f.error("values",
                fmt::format("profile '{}' has {} hours and {} values", name.name, hours.size(), values.size()));
    }
    for (std::size_t i = 1; i < hours.size(); ++i) {
        if (hours[i] <= hours[i - 1]) {
            f.error("hours", fmt::format("the hours of profile '{}' do not increase at {}", name.name, hours[i]));
            break;
        }
    }
}

double Profile::value_at(double hours_since_start, double start_hour_of_day) const {
    double const at =
        time == Time::hour_of_day ? std::fmod(start_hour_of_day + hours_since_start, 24.0) : hours_since_start;
    double value = 1;
    if (half_sine) {
        double const x = (at - half_sine->rise_h) / (half_sine->set_h - half_sine->rise_h);
        value = x <= 0 || x >= 1 ? 0 : std::pow(std::sin(std::numbers::pi * x), half_sine->exponent);
    } else if (!hours.empty()) {
        auto const next = std::upper_bound(hours.begin(), hours.end(), at);
        if (next == hours.begin()) {
            value = values.front();
        } else if (next == hours.end()) {
            value = values.back();
        } else {
            auto const i = static_cast<std::size_t>(next - hours.begin());
            double const share = (at - hours[i - 1]) / (hours[i] - hours[i - 1]);
            value = values[i - 1] + share * (values[i] - values[i - 1]);
        }
    }
    for (Cloud const& cloud : clouds) {
        double const x = (at - cloud.at_h) / cloud.width_h;
        value *= 1 - cloud.depth_percent / 100 * std::exp(-x * x);
    }
    return value;
}

} // namespace gridspace::sim
