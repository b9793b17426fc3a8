// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/line/frequency_table.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <numbers>

namespace gridspace::sim {
namespace {

/// The largest root mean square of relative errors with which r and l still belong together.
constexpr double kLargestTableError = 0.03;

} // namespace

void FrequencyTable::fields(config::Fields& f) {
    using namespace elements;
    f.object("by_frequency", {.doc = "resistance and inductance over frequency, instead of single ones"},
             [&](config::Fields& g) {
                 g.numbers("hz", hz, positive("frequencies, rising", true));
                 g.numbers("r_ohm_per_km", r_ohm_per_km, positive("resistances, positive sequence", true));
                 g.numbers("l_mh_per_km", l_mh_per_km, positive("inductances, positive sequence", true));
                 g.numbers("r0_ohm_per_km", r0_ohm_per_km, positive("resistances, zero sequence", true));
                 g.numbers("l0_mh_per_km", l0_mh_per_km, positive("inductances, zero sequence", true));
             });
    if (given() && shape_mistake().empty()) {
        std::vector<double> omega;
        std::vector<std::complex<double>> z1, z0; // ohm per m
        for (std::size_t i = 0; i < hz.size(); ++i) {
            omega.push_back(2 * std::numbers::pi * hz[i]);
            z1.emplace_back(1e-3 * r_ohm_per_km[i], omega[i] * 1e-6 * l_mh_per_km[i]);
            z0.emplace_back(1e-3 * r0_ohm_per_km[i], omega[i] * 1e-6 * l0_mh_per_km[i]);
        }
        one_ = fit_series(omega, z1);
        zero_ = fit_series(omega, z0);
        error_ = std::max(series_error(omega, z1, one_), series_error(omega, z0, zero_));
    }
}

std::string FrequencyTable::shape_mistake() const {
    for (auto const* column : {&r_ohm_per_km, &l_mh_per_km, &r0_ohm_per_km, &l0_mh_per_km}) {
        if (column->size() != hz.size()) {
            return fmt::format("it has {} frequencies and {} values", hz.size(), column->size());
        }
    }
    if (hz.size() < 2) {
        return "it has one frequency";
    }
    return std::ranges::adjacent_find(hz, std::greater_equal<>{}) == hz.end() ? "" : "its frequencies do not rise";
}

std::string FrequencyTable::mistake() const {
    std::string shape = shape_mistake();
    if (!shape.empty() || error_ <= kLargestTableError) {
        return shape;
    }
    return fmt::format(
        "its r and l do not belong together: resistances and inductances that come nearest are {:.2g} % away",
        100 * error_);
}

SequencesPerMetre FrequencyTable::per_metre(double omega) const {
    return {one_.at(omega), zero_.at(omega), 0, 0};
}

} // namespace gridspace::sim
