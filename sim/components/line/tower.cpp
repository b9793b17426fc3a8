// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/line/tower.hpp"

#include "sim/components/faces/number_specs.hpp"
#include "sim/line_constants/line_constants.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {
namespace {

/// Own minus mutual, own plus twice mutual, of the transposed phases.
template <class Matrix>
auto sequence_values(Matrix const& m) {
    auto const own = m.trace() / 3.0;
    auto const mutual = (m.sum() - m.trace()) / 6.0;
    return std::pair{own - mutual, own + 2.0 * mutual};
}

} // namespace

void Tower::fields(config::Fields& f) {
    using namespace elements;
    f.list("conductors", {.doc = "conductors over earth, instead of values per km"}, [&](Fields& c) {
        Wire wire;
        c.choice<Belongs>("phase", wire.phase,
                          {{"a", Belongs::a}, {"b", Belongs::b}, {"c", Belongs::c}, {"earth", Belongs::earth}},
                          {.doc = "whose it is; several of one phase are a bundle", .required = true});
        c.number("x_m", wire.x_m, any("place across the line", true));
        c.number("height_m", wire.height_m, positive("mean height over the earth", true));
        c.number("radius_m", wire.radius_m, positive("radius of a round wire", true));
        c.number("dc_ohm_per_km", wire.dc_ohm_per_km, positive("resistance to direct current", true));
        wires.push_back(wire);
    });
    f.number("earth_ohm_m", earth_ohm_m, positive("resistivity of the earth, with conductors"));
}

std::string Tower::mistake() const {
    std::array<bool, 4> seen{};
    for (std::size_t i = 0; i < wires.size(); ++i) {
        Wire const& a = wires[i];
        seen[static_cast<std::size_t>(a.phase)] = true;
        if (a.height_m <= a.radius_m) {
            return fmt::format("its conductor {} touches the earth", i + 1);
        }
        for (std::size_t j = 0; j < i; ++j) {
            Wire const& b = wires[j];
            if (std::hypot(a.x_m - b.x_m, a.height_m - b.height_m) <= a.radius_m + b.radius_m) {
                return fmt::format("its conductors {} and {} are in one place", j + 1, i + 1);
            }
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if (!seen[k]) {
            return fmt::format("phase {} has no conductor", "abc"[k]);
        }
    }
    return {};
}

SequencesPerMetre Tower::per_metre(double omega) const {
    std::vector<Conductor> conductors;
    auto const n = static_cast<Eigen::Index>(wires.size());
    Eigen::MatrixXd belongs = Eigen::MatrixXd::Zero(n, 3);
    for (Wire const& w : wires) {
        if (w.phase != Belongs::earth) {
            belongs(static_cast<Eigen::Index>(conductors.size()), static_cast<Eigen::Index>(w.phase)) = 1;
        }
        conductors.push_back({w.x_m, w.height_m, w.dc_ohm_per_km * 1e-3, 0, 0, w.radius_m});
    }
    LineConstants const all =
        line_constants(conductors, static_cast<int>(n), omega / (2 * std::numbers::pi), earth_ohm_m, EarthModel::deri);
    // One voltage per phase: admittances add up.
    Eigen::Matrix3cd const y = belongs.transpose() * all.z_ohm_per_m.inverse() * belongs;
    Eigen::Matrix3d const c = belongs.transpose() * all.c_f_per_m * belongs;
    SequencesPerMetre out;
    std::tie(out.z1_ohm, out.z0_ohm) = sequence_values(Eigen::Matrix3cd{y.inverse()});
    // Of the potential coefficients, as of the impedances: both modes then tend to the speed of light.
    auto const [p1, p0] = sequence_values(Eigen::Matrix3d{c.inverse()});
    out.c1_f = 1 / p1;
    out.c0_f = 1 / p0;
    return out;
}

} // namespace gridspace::sim
