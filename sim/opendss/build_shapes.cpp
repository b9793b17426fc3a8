// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

/// Load shapes: what loads, generators and panels do at an hour.
namespace gridspace::opendss {
namespace {

struct ShapeData {
    double interval_h{1}; ///< 0: each value has an hour of its own
    std::vector<double> p, q, hours;
    bool actual{false};

    /// Of values at even intervals: the first is that of the first interval's end, and the shape repeats.
    [[nodiscard]] std::size_t place(double hour) const {
        double const index = std::fmod(std::round(hour / interval_h), static_cast<double>(p.size()));
        return index < 1 ? p.size() - 1 : static_cast<std::size_t>(index) - 1;
    }
    /// Of values at hours of their own: between two of them on a straight line. After the last it begins anew.
    [[nodiscard]] double between(std::vector<double> const& values, double hour) const {
        std::size_t const n = std::min(values.size(), hours.size());
        if (n == 0) {
            return values.front();
        }
        double const last = hours[n - 1];
        double const at = hour > last && last > 0 ? std::fmod(hour, last) : hour;
        std::size_t next = 0;
        while (next < n && hours[next] < at) {
            ++next;
        }
        if (next == 0 || next == n) {
            return values[next == 0 ? 0 : n - 1];
        }
        double const share = (at - hours[next - 1]) / (hours[next] - hours[next - 1]);
        return values[next - 1] + share * (values[next] - values[next - 1]);
    }
    [[nodiscard]] ShapeValue at(double hour) const {
        if (interval_h > 0) {
            std::size_t const i = place(hour);
            return {p[i], i < q.size() ? q[i] : actual ? 0 : p[i], actual};
        }
        double const active = between(p, hour);
        return {active, !q.empty() ? between(q, hour) : actual ? 0 : active, actual};
    }
};

} // namespace

void Builder::leave_out_once(config::SourceMark const& where, std::string what) {
    bool const known = std::any_of(circuit_.left_out.begin(), circuit_.left_out.end(),
                                   [&](LeftOut const& left) { return left.what == what; });
    if (!known) {
        circuit_.left_out.push_back({where, std::move(what), true});
    }
}

ShapeValue Builder::shape(std::string const& name, config::SourceMark const& where) {
    if (name.empty() || lower(name) == "none") {
        return {};
    }
    Object const* object = script_.find("loadshape", lower(name));
    if (object == nullptr) {
        if (hour_) {
            error(where, fmt::format("there is no loadshape '{}'", name));
        }
        return {};
    }
    ShapeData data;
    auto const not_read = [&](Value const& v) {
        if (hour_) {
            leave_out_once(v.where(), fmt::format("the file of loadshape.{}: taken as 1", object->name));
        }
    };
    auto const take = [&](std::vector<double>& into) {
        return [&, not_read](Value const& v) {
            if (lower(v.text()).find("file") != std::string::npos) {
                not_read(v);
                return;
            }
            into = v.list();
        };
    };
    replay(*object,
           {{"interval", [&](Value const& v) { data.interval_h = v.not_negative(); }},
            {"minterval", [&](Value const& v) { data.interval_h = v.not_negative() / 60; }},
            {"sinterval", [&](Value const& v) { data.interval_h = v.not_negative() / 3600; }},
            {"useactual", [&](Value const& v) { data.actual = v.yes(); }},
            {"interpolation",
             [&](Value const& v) {
                 if (hour_ && lower(v.text()).starts_with('e')) {
                     leave_out_once(v.where(), fmt::format("the edges of loadshape.{}: interpolated", object->name));
                 }
             }},
            {"csvfile", not_read},
            {"sngfile", not_read},
            {"dblfile", not_read},
            {"pqcsvfile", not_read},
            {"mult", take(data.p)},
            {"pmult", take(data.p)},
            {"qmult", take(data.q)},
            {"hour", take(data.hours)}},
           diagnostics_);
    if (hour_ && !data.p.empty()) {
        return data.at(*hour_);
    }
    if (!hour_ && data.actual) { // OpenDSS takes its largest value
        leave_out_once(object->where,
                       fmt::format("UseActual of loadshape.{}: without an hour kW are as given", object->name));
    }
    return {};
}

} // namespace gridspace::opendss
