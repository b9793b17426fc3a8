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

/// Ohm per metre at an angular frequency, of columns per km.
std::complex<double> from_columns(std::vector<double> const& hz, std::vector<double> const& r_ohm,
                                  std::vector<double> const& l_mh, double omega) {
    double const f = omega / (2 * std::numbers::pi);
    auto const after = static_cast<std::size_t>(std::upper_bound(hz.begin(), hz.end(), f) - hz.begin());
    double r = r_ohm.front(), l = l_mh.front();
    if (after == hz.size()) {
        r = r_ohm.back() * std::sqrt(f / hz.back());
        // The inner reactance of a thick wire is its resistance.
        l = l_mh.back() + 1e3 / (2 * std::numbers::pi) * (r / f - r_ohm.back() / hz.back());
    } else if (after > 0) {
        double const share = std::log(f / hz[after - 1]) / std::log(hz[after] / hz[after - 1]);
        r = r_ohm[after - 1] * std::pow(r_ohm[after] / r_ohm[after - 1], share);
        l = l_mh[after - 1] + share * (l_mh[after] - l_mh[after - 1]);
    }
    return {1e-3 * r, omega * 1e-6 * l};
}

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
}

std::string FrequencyTable::mistake() const {
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

SequencesPerMetre FrequencyTable::per_metre(double omega) const {
    return {from_columns(hz, r_ohm_per_km, l_mh_per_km, omega), from_columns(hz, r0_ohm_per_km, l0_mh_per_km, omega), 0,
            0};
}

} // namespace gridspace::sim
