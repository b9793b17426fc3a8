// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/mapping.hpp"

#include <array>
#include <utility>

namespace gridspace::mapping {
namespace {

constexpr std::array<std::string_view, 14> kBase{"A",   "V",  "W",    "VA",   "var", "Hz", "s",
                                                 "ohm", "Wh", "varh", "degC", "deg", "pu", "%"};
constexpr std::array<std::pair<char, double>, 6> kPrefix{
    {{'n', 1e-9}, {'u', 1e-6}, {'m', 1e-3}, {'k', 1e3}, {'M', 1e6}, {'G', 1e9}}};

struct Unit {
    std::string_view base;
    double factor;
};

std::optional<Unit> parse(std::string_view unit) {
    for (std::string_view const base : kBase) {
        if (unit == base) {
            return Unit{base, 1};
        }
        if (unit.size() == base.size() + 1 && unit.substr(1) == base) {
            for (auto const& [letter, factor] : kPrefix) {
                if (unit[0] == letter) {
                    return Unit{base, factor};
                }
            }
        }
    }
    return std::nullopt;
}

} // namespace

bool is_unit(std::string_view unit) {
    return parse(unit).has_value();
}

std::optional<double> unit_factor(std::string_view from, std::string_view to) {
    auto const a = parse(from), b = parse(to);
    if (!a || !b) {
        return std::nullopt;
    }
    if (a->base == b->base) {
        return a->factor / b->factor;
    }
    if (a->base == "%" && b->base == "pu") {
        return 0.01 * a->factor / b->factor;
    }
    if (a->base == "pu" && b->base == "%") {
        return 100 * a->factor / b->factor;
    }
    return std::nullopt;
}

} // namespace gridspace::mapping
