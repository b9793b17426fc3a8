// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_value.hpp"

#include "sim/opendss/dss_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::opendss {

void Value::wrong(std::string const& what, std::string const& expected) const {
    diagnostics_.error(word_.where, fmt::format("{}.{}: {} {}", object_.info->name, object_.name, property_, what),
                       expected, std::max(1, static_cast<int>(word_.value.size())));
}

double Value::number() const {
    return evaluate(word_, diagnostics_).value_or(0);
}

double Value::positive() const {
    auto const value = evaluate(word_, diagnostics_);
    if (value && !(*value > 0)) {
        wrong(fmt::format("is {}", *value), "expected more than 0");
    }
    return value && *value > 0 ? *value : 1;
}

double Value::not_negative() const {
    auto const value = evaluate(word_, diagnostics_);
    if (value && !(*value >= 0)) {
        wrong(fmt::format("is {}", *value), "expected 0 or more");
    }
    return value && *value >= 0 ? *value : 0;
}

int Value::integer(int least, int most) const {
    auto const value = evaluate(word_, diagnostics_);
    if (!value) {
        return least;
    }
    if (!(*value >= least && *value <= most) || std::floor(*value) != *value) {
        wrong(fmt::format("is {}", *value), fmt::format("expected a whole number from {} to {}", least, most));
        return least;
    }
    return static_cast<int>(*value);
}

bool Value::yes() const {
    std::string const first = lower(text().substr(0, 1));
    if (first.empty() || std::string_view{"ytnf10"}.find(first) == std::string_view::npos) {
        wrong(fmt::format("is '{}'", text()), "expected yes or no");
    }
    return first == "y" || first == "t" || first == "1";
}

bool Value::delta() const {
    std::string const word = lower(text());
    bool const is_delta = word.starts_with('d') || word == "ll";
    if (!is_delta && !word.starts_with('w') && !word.starts_with('y') && word != "ln") {
        wrong(fmt::format("is '{}'", text()), "expected wye or delta");
    }
    return is_delta;
}

std::vector<double> Value::list() const {
    std::vector<double> out;
    auto const rows = rows_of(word_, diagnostics_);
    for (std::size_t i = 0; rows && i < rows->size(); ++i) {
        out.insert(out.end(), (*rows)[i].begin(), (*rows)[i].end());
    }
    return out;
}

std::vector<Word> Value::words() const {
    return items_of(word_, diagnostics_);
}

Complex Value::complex() const {
    std::vector<double> const parts = list();
    if (parts.size() != 2) {
        wrong(fmt::format("has {} numbers", parts.size()), "expected [real imaginary]");
        return {};
    }
    return {parts[0], parts[1]};
}

Eigen::MatrixXd Value::matrix(int order) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(order, order);
    auto rows = rows_of(word_, diagnostics_);
    if (!rows) {
        return out;
    }
    auto const n = static_cast<std::size_t>(order);
    if (rows->size() == 1 && rows->front().size() == n * n && n > 1) { // all of it, without bars
        std::vector<double> const all = rows->front();
        rows->assign(n, {});
        for (std::size_t i = 0; i < n * n; ++i) {
            (*rows)[i / n].push_back(all[i]);
        }
    }
    bool fits = rows->size() == n;
    bool const whole = std::all_of(rows->begin(), rows->end(), [&](auto const& row) { return row.size() == n; });
    for (std::size_t i = 0; fits && i < n; ++i) {
        std::vector<double> const& row = (*rows)[i];
        fits = whole || row.size() == i + 1;
        for (std::size_t j = 0; fits && j < row.size(); ++j) {
            out(static_cast<int>(i), static_cast<int>(j)) = row[j];
            if (!whole) {
                out(static_cast<int>(j), static_cast<int>(i)) = row[j];
            }
        }
    }
    if (!fits) {
        wrong(fmt::format("is no matrix of order {}", order), "expected its lower triangle, rows parted by '|'");
    }
    return out;
}

void replay(Object const& object, Meaning const& meaning, config::Diagnostics& diagnostics,
            std::function<void()> const& after_command) {
    bool first = true;
    for (Assignment const& a : object.assignments) {
        if (a.begins && !first && after_command) {
            after_command();
        }
        first = false;
        std::string_view const property = object.info->properties[a.property];
        if (auto const it = meaning.find(property); it != meaning.end()) {
            it->second(Value{a.value, object, property, diagnostics});
        }
    }
    if (after_command) {
        after_command();
    }
}

double metres(Value const& unit) {
    static constexpr std::pair<std::string_view, double> kUnits[] = {{"no", 0},      {"mi", 1609.344}, {"kf", 304.8},
                                                                     {"km", 1000},   {"me", 1},        {"ft", 0.3048},
                                                                     {"in", 0.0254}, {"cm", 0.01},     {"mm", 0.001}};
    std::string const word = lower(unit.text());
    if (word == "m") {
        return 1;
    }
    for (auto const& [begin, length] : kUnits) {
        if (word.starts_with(begin)) {
            return length;
        }
    }
    unit.wrong(fmt::format("is '{}'", unit.text()), "expected mi, kft, km, m, ft, in, cm, mm or none");
    return 0;
}

bool enabled(Object const& object) {
    bool out = true;
    for (Assignment const& a : object.assignments) {
        if (object.info->properties[a.property] == "enabled") {
            std::string const word = lower(a.value.value);
            out = !(word.starts_with('n') || word.starts_with('f') || word == "0");
        }
    }
    return out;
}

} // namespace gridspace::opendss
