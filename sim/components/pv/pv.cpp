// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/pv/pv.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Pv::fields(Fields& f) {
    f.number("p_kw", p_kw, not_negative("power at full sun; with an `array` its cells say it"));
    f.number("rating_kva", rating_kva, not_negative("apparent power that it cannot exceed; 0: no limit"));
    f.number("power_factor", power_factor, at_most_one("of the inverter"));
    f.reference("scale", scale, {.doc = "profile of the sun, p.u. of 1000 W/m2"});
    f.number("ambient_c", ambient_c, any("temperature of the air"));
    f.reference("ambient", ambient, {.doc = "profile that multiplies ambient_c"});
    f.object("array", {.doc = "its cells, by their single-diode model"}, [&](Fields& g) { array.emplace().fields(g); });
    if (!array && !f.has("p_kw")) {
        f.error("p_kw", fmt::format("'{}' has neither a power at full sun nor cells", name.name),
                "give its p_kw, or an `array`");
    } else if (array && f.has("p_kw")) {
        f.error("p_kw", fmt::format("'{}' has an array, whose cells say its power", name.name),
                "leave one of both out");
    } else if (array) {
        PvArray::Module const module = array->module_at(1, 25 - (array->noct_c - 20) / 0.8);
        p_kw = array->kw(module.power_w(module.best()));
    } else if (f.has("ambient_c") || f.has("ambient")) {
        f.error(f.has("ambient_c") ? "ambient_c" : "ambient",
                fmt::format("'{}' has no array, and nothing depends on the temperature", name.name),
                "leave it out, or give an `array`");
    }
    describe_ride_through(f, ride_through);
}

PvArray::Module Pv::module_at(Weather const& weather) const {
    return array->module_at(irradiance_pu.value_or(weather.sun), ambient_c * weather.ambient);
}

double Pv::available_kw(Weather const& weather) const {
    if (!array) {
        return p_kw * irradiance_pu.value_or(weather.sun);
    }
    PvArray::Module const module = module_at(weather);
    return array->kw(module.power_w(module.best()));
}

double Pv::tracked_kw(Weather const& weather, double diode_v) const {
    return std::max(0.0, array->kw(module_at(weather).power_w(diode_v)));
}

Complex Pv::power_kva(double most_kw) const {
    double p = most_kw;
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
           : quantity == "q_kvar"     ? power_kva(p_kw).imag()
           : quantity == "p_limit_kw" ? p_limit_kw.value_or(p_kw)
                                      : irradiance_pu.value_or(1);
}

namespace {

std::vector<SignalDef> array_signals(Pv const& pv) {
    return pv.array ? std::vector<SignalDef>{{"available_kw", "kW"},
                                             {"dc_voltage_v", "V"},
                                             {"dc_current_a", "A"},
                                             {"cell_c", "degC"}}
                    : std::vector<SignalDef>{};
}

/// Its cells give `kw`, at most what they can.
double array_value(Pv const& pv, std::size_t signal, Pv::Weather const& weather, double kw) {
    PvArray const& array = *pv.array;
    if (signal == 3) {
        return array.cell_c(pv.irradiance_pu.value_or(weather.sun), pv.ambient_c * weather.ambient);
    }
    PvArray::Module const module = pv.module_at(weather);
    double const most = module.power_w(module.best());
    double const at = module.above_best(std::min(array.module_w(kw), most));
    double const values[] = {array.kw(most), array.series * module.voltage_v(at), array.strings * module.current_a(at)};
    return values[signal];
}

/// State, of an array whose tracker takes time: the voltage across the diodes of a module.
class PvInjection final : public PowerInjection {
  public:
    PvInjection(Pv const& pv, Surroundings const& around)
        : PowerInjection{Pv::kKind, pv.name, around.bus(pv.bus), around.base_kva()}, pv_{pv},
          sun_{around.scale(pv.scale)}, ambient_{around.scale(pv.ambient)} {}
    [[nodiscard]] std::size_t states() const override { return pv_.array && pv_.array->mppt_s > 0 ? 1 : 0; }
    void start(double t, Complex, Complex, std::span<double> x) override {
        if (states() > 0) {
            x[0] = pv_.module_at(weather(t)).best();
        }
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return powers_and(array_signals(pv_)); }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        return signal < 2 ? PowerInjection::value(signal, t, x, v)
                          : array_value(pv_, signal - 2, weather(t), PowerInjection::value(0, t, x, v));
    }
    bool set(double, std::string_view quantity, double value) override { return pv_.set(quantity, value); }

  private:
    [[nodiscard]] Pv::Weather weather(double t) const { return {sun_(t), ambient_(t)}; }
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override {
        double const most = states() > 0 ? pv_.tracked_kw(weather(t), x[0]) : pv_.available_kw(weather(t));
        return within_rating(pv_.power_kva(most), v, pv_.inverter_kva()) / base_kva();
    }
    void slopes(double t, std::span<double const> x, Complex, std::span<double> dx) const override {
        if (states() > 0) {
            dx[0] = (pv_.module_at(weather(t)).best() - x[0]) / pv_.array->mppt_s;
        }
    }
    Pv pv_;
    Scale sun_, ambient_;
};

class PvPower final : public PowerModel {
  public:
    PvPower(Pv const& pv, Scale sun, Scale ambient) : pv_{pv}, sun_{std::move(sun)}, ambient_{std::move(ambient)} {}
    void start(double) override {
        weather_ = {sun_(0), ambient_(0)};
        diode_v_ = pv_.array ? pv_.module_at(weather_).best() : 0;
    }
    Complex power_va(double t, double, double h) override {
        weather_ = {sun_(t), ambient_(t)};
        double most = 0;
        if (pv_.array && pv_.array->mppt_s > 0) {
            diode_v_ += (pv_.module_at(weather_).best() - diode_v_) * (h / (pv_.array->mppt_s + h));
            most = pv_.tracked_kw(weather_, diode_v_);
        } else {
            most = pv_.available_kw(weather_);
        }
        Complex const kva = pv_.power_kva(most);
        given_kw_ = kva.real();
        return 1e3 * kva;
    }
    void disconnect() override { given_kw_ = 0; }
    bool set(std::string_view quantity, double value) override { return pv_.set(quantity, value); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return array_signals(pv_); }
    [[nodiscard]] double value(std::size_t signal) const override {
        return array_value(pv_, signal, weather_, given_kw_);
    }

  private:
    Pv pv_;
    Scale sun_, ambient_;
    Pv::Weather weather_;
    double diode_v_{0}, given_kw_{0};
};

} // namespace

std::unique_ptr<PhasorInjection> Pv::phasor(Surroundings const& around) const {
    return std::make_unique<PvInjection>(*this, around);
}

void Pv::circuit(CircuitFace& face) const {
    face.converter(*this, inverter_kva(), std::make_unique<PvPower>(*this, face.scale(scale), face.scale(ambient)),
                   ride_through);
}

} // namespace gridspace::sim
