// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <string_view>

/// Ranges of numbers in a network file.
namespace gridspace::sim::elements {

using config::Fields;
using config::NumberSpec;

constexpr NumberSpec any(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    return spec;
}
constexpr NumberSpec positive(std::string_view doc, bool required = false) {
    NumberSpec spec = any(doc, required);
    spec.above = 0;
    return spec;
}
constexpr NumberSpec at_most_one(std::string_view doc) {
    NumberSpec spec = positive(doc);
    spec.max = 1;
    return spec;
}
constexpr NumberSpec not_negative(std::string_view doc, bool required = false) {
    NumberSpec spec = any(doc, required);
    spec.min = 0;
    return spec;
}
constexpr NumberSpec percent(std::string_view doc, bool required = false) {
    NumberSpec spec = not_negative(doc, required);
    spec.max = 100;
    return spec;
}

/// A frequency that a network of a nominal one can have in a run.
constexpr NumberSpec near_nominal(NumberSpec spec, double nominal_hz) {
    spec.min = nominal_hz / 2;
    spec.max = nominal_hz * 3 / 2;
    spec.above = NumberSpec{}.above;
    return spec;
}

} // namespace gridspace::sim::elements
