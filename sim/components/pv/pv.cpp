// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/pv/pv.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim {

using namespace elements;

void Pv::fields(Fields& f) {
    f.number("p_kw", p_kw, not_negative("power at full sun", true));
    f.number("rating_kva", rating_kva, not_negative("apparent power that it cannot exceed; 0: no limit"));
    f.number("power_factor", power_factor, at_most_one("of the inverter"));
    f.reference("scale", scale, {.doc = "profile of the sun"});
    describe_ride_through(f, ride_through);
}

Complex Pv::power_kva(double sun) const {
    double p = p_kw * irradiance_pu.value_or(sun);
    if (p_limit_kw) {
        p = std::min(p, *p_limit_kw);
    }
    if (q_kvar) {
        double const rating = inverter_kva(), q = std::clamp(*q_kvar, -rating, rating);
        return {std::min(p, std::sqrt(rating * rating - q * q)), q};
    }
    if (rating_kva > 0) {
        p = std::min(p, rating_kva * power_factor);
    }
    return {p, -p * std::sqrt(1 - power_factor * power_factor) / power_factor};
}

bool Pv::set(std::string_view quantity, double value) {
    if (quantity == "power_factor") {
        rating_kva = inverter_kva(); // another power factor does not make it larger
        power_factor = value;
        q_kvar.reset();
    } else {
        (quantity == "p_limit_kw" ? p_limit_kw : quantity == "q_kvar" ? q_kvar : irradiance_pu) = value;
    }
    return true;
}

double Pv::value(std::string_view quantity, Surroundings const&) const {
    return quantity == "power_factor" ? power_factor
           : quantity == "q_kvar"     ? power_kva(1).imag()
           : quantity == "p_limit_kw" ? p_limit_kw.value_or(p_kw)
                                      : irradiance_pu.value_or(1);
}

namespace {

class PvInjection final : public PowerInjection {
  public:
    PvInjection(Pv const& pv, Surroundings const& around)
        : PowerInjection{Pv::kKind, pv.name, around.bus(pv.bus), around.base_kva()}, pv_{pv},
          sun_{around.scale(pv.scale)} {}
    bool set(double, std::string_view quantity, double value) override { return pv_.set(quantity, value); }

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
    bool set(std::string_view quantity, double value) override { return pv_.set(quantity, value); }

  private:
    Pv pv_;
    Scale sun_;
};

} // namespace

std::unique_ptr<PhasorInjection> Pv::phasor(Surroundings const& around) const {
    return std::make_unique<PvInjection>(*this, around);
}

void Pv::circuit(CircuitFace& face) const {
    face.converter(*this, inverter_kva(), std::make_unique<PvPower>(*this, face.scale(scale)), ride_through);
}

} // namespace gridspace::sim
