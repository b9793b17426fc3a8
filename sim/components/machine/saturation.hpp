// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace gridspace::sim::machines {

/// Saturation by two points of its factor Se: Se(E) = B (E - A)^2 / E above A and 0 below, the quadratic form of PSS/E.
/// IEEE 421.5 gives the two points of an exciter and leaves the form open.
struct Saturation {
    double a{0}, b{0};

    /// E Se(E): what is needed in addition to E.
    [[nodiscard]] double drop(double e) const {
        double const above = std::max(e - a, 0.0);
        return b * above * above;
    }
    /// Whether a curve with A of 0 or more goes through both points.
    [[nodiscard]] static bool fits(double e1, double s1, double e2, double s2) {
        return e1 < e2 ? s2 * e1 >= s1 * e2 : e2 < e1 && s1 * e2 >= s2 * e1;
    }
    /// Through two points that fit.
    [[nodiscard]] static Saturation through(double e1, double s1, double e2, double s2) {
        double const r1 = std::sqrt(e1 * s1), r2 = std::sqrt(e2 * s2);
        if (r1 == r2) {
            return {};
        }
        double const root_b = (r2 - r1) / (e2 - e1);
        return {e1 - r1 / root_b, root_b * root_b};
    }
};

} // namespace gridspace::sim::machines
