// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/shared_checks.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::elements {

void check_least_impedance(ElementCheck& check, Ref const& bus, double positive_ohm, double zero_ohm) {
    if (check.around().element("buses", bus) == nullptr) {
        return;
    }
    double const least = kMinImpedancePu * check.around().base_ohm(bus);
    double const smaller = std::min(positive_ohm, zero_ohm);
    if (smaller > 0 && smaller < least) {
        check.wrong(fmt::format("has {} ohm{}, too little to compute its current: at least {:.2g} ohm are needed here",
                                shortest(smaller), smaller < positive_ohm ? " in the zero sequence" : "", least),
                    "make its two ends one bus, or give it more");
    }
}

} // namespace gridspace::sim::elements
