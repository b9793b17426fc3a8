// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/pv/pv.hpp"

#include "sim/components/faces/converter.hpp"
#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim {

using namespace elements;

void Pv::fields(Fields& f) {
    f.number("p_kw", p_kw, not_negative("power at full sun", true));
    f.number("rating_kva", rating_kva, not_negative("apparent power that it cannot exceed; 0: no limit"));
    f.number("power_factor", power_factor, at_most_one("of the inverter"));
    f.reference("scale", scale, {.doc = "profile of the sun"});
}

Complex Pv::power_kva(double sun) const {
    double p = p_kw * sun;
    if (rating_kva > 0) {
        p = std::min(p, rating_kva * power_factor);
    }
    return {p, -p * std::sqrt(1 - power_factor * power_factor) / power_factor};
}

namespace {

class PvInjection final : public PowerInjection {
  public:
    PvInjection(Pv const& pv, Surroundings const& around)
        : PowerInjection{Pv::kKind, pv.name, around.bus(pv.bus), around.base_kva()}, pv_{pv},
          sun_{around.scale(pv.scale)} {}

  private:
    [[nodiscard]] Complex power(double t, std::span<double const>, double v) const override {
        return within_rating(pv_.power_kva(sun_(t)), v, pv_.inverter_kva()) / base_kva();
    }
    Pv pv_;
    Scale sun_;
};

class PvPower final : public PowerModel {
  public:
    PvPower(Pv const& pv, Scale sun) : pv_{pv}, sun_{std::move(sun)} {}
    Complex power_va(double t, double, double) override { return 1e3 * pv_.power_kva(sun_(t)); }

  private:
    Pv pv_;
    Scale sun_;
};

} // namespace

std::unique_ptr<PhasorInjection> Pv::phasor(Surroundings const& around) const {
    return std::make_unique<PvInjection>(*this, around);
}

void Pv::circuit(CircuitFace& face) const {
    face.converter(*this, inverter_kva(), std::make_unique<PvPower>(*this, face.scale(scale)));
}

} // namespace gridspace::sim
