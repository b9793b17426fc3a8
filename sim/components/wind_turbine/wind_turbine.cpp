// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/wind_turbine/wind_turbine.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void WindTurbine::fields(Fields& f) {
    f.number("rated_kw", rated_kw, positive("power at rated wind", true));
    f.number("rating_kva", rating_kva, not_negative("of the converter; 0: 1.1 of rated_kw"));
    f.number("wind_m_s", wind_m_s, not_negative("wind"));
    f.reference("scale", scale, {.doc = "profile that multiplies the wind"});
    f.number("q_kvar", q_kvar, any("reactive power into the network"));
    f.choice<WindGenerator>(
        "generator", generator,
        {{"full_converter", WindGenerator::full_converter}, {"doubly_fed", WindGenerator::doubly_fed}},
        {.doc = "type 4, whose rotor does not notice a fault, or type 3, whose rotor speeds up in one"});
    rotor_fields(f, rotor);
    describe_ride_through(f, ride_through);
    if (rated_kw > 0 && rating_kva > 0 && std::hypot(rated_kw, q_kvar) > rating_kva * (1 + 1e-9)) {
        f.error("rating_kva",
                fmt::format("rated_kw and q_kvar of '{}' are {:.4g} kVA, more than its rating", name.name,
                            std::hypot(rated_kw, q_kvar)),
                "give it a larger rating_kva or a smaller q_kvar");
    }
}

void WindTurbine::check(ElementCheck& check) const {
    check.profile(scale);
    if (wind_m_s <= rotor.cut_out_m_s && !wind::steady_state(rotor, wind_m_s, true)) {
        check.wrong(fmt::format("cannot hold its rated power at {} m/s: pitch.max_deg of {} is too little", wind_m_s,
                                rotor.pitch.max_deg),
                    "make pitch.max_deg larger");
    }
}

Complex WindTurbine::power_kva(double taken_pu) const {
    double const rating = converter_kva(), q = std::clamp(q_kvar, -rating, rating);
    return {std::min(taken_pu * rated_kw, std::sqrt(rating * rating - q * q)), q};
}

wind::Operation WindTurbine::operation(double wind, bool runs) const {
    return {.wind_m_s = wind, .limit_pu = p_limit_kw ? *p_limit_kw / rated_kw : 1, .runs = runs};
}

wind::State WindTurbine::start(double wind) const {
    bool const runs = wind::goes_on(rotor, wind, true);
    return wind::steady_state(rotor, wind, runs).value_or(*wind::steady_state(rotor, rotor.rated_wind_m_s, true));
}

void WindTurbine::power_flow(PowerFlowFace& face) const {
    face.inject(bus, power_kva(start(wind(face.scale(scale)))[wind::kPower]));
}

bool WindTurbine::set(std::string_view quantity, double value) {
    if (quantity == "q_kvar") {
        q_kvar = value;
    } else {
        (quantity == "p_limit_kw" ? p_limit_kw : wind_set_m_s) = value;
    }
    return true;
}

double WindTurbine::value(std::string_view quantity, Surroundings const&) const {
    return quantity == "q_kvar"       ? q_kvar
           : quantity == "p_limit_kw" ? p_limit_kw.value_or(rated_kw)
                                      : wind_set_m_s.value_or(wind_m_s);
}

namespace {

std::vector<SignalDef> wind_signals() {
    return {{"rotor_speed_pu", ""}, {"pitch_deg", "deg"}, {"wind_m_s", "m/s"}, {"available_kw", "kW"}};
}

double wind_value(WindTurbine const& turbine, std::size_t signal, wind::State const& x, double wind, bool runs) {
    double const share = std::min(1.0, wind / turbine.rotor.rated_wind_m_s);
    double const values[] = {x[wind::kMachine], x[wind::kPitch], wind,
                             runs ? turbine.rated_kw * share * share * share : 0};
    return values[signal];
}

/// States: of the rotor. Stopping in a storm and starting again are events.
class WindInjection final : public PowerInjection {
  public:
    WindInjection(WindTurbine const& turbine, Surroundings const& around)
        : PowerInjection{WindTurbine::kKind, turbine.name, around.bus(turbine.bus), around.base_kva()},
          turbine_{turbine}, scale_{around.scale(turbine.scale)} {}
    [[nodiscard]] std::size_t states() const override { return wind::kStates; }
    void start(double t, Complex, Complex, std::span<double> x) override {
        double const wind = turbine_.wind(scale_(t));
        std::ranges::copy(turbine_.start(wind), x.begin());
        runs_ = wind::goes_on(turbine_.rotor, wind, true);
    }
    [[nodiscard]] bool has_event() const override { return true; }
    [[nodiscard]] double event(double t, std::span<double const>) const override {
        double const wind = turbine_.wind(scale_(t));
        return runs_ ? turbine_.rotor.cut_out_m_s - wind : wind - turbine_.rotor.restart_m_s;
    }
    void on_event(std::span<double>) override { runs_ = !runs_; }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return powers_and(wind_signals()); }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        return signal < 2 ? PowerInjection::value(signal, t, x, v)
                          : wind_value(turbine_, signal - 2, rotor_state(x), turbine_.wind(scale_(t)), runs_);
    }
    bool set(double t, std::string_view quantity, double value) override {
        bool const done = turbine_.set(quantity, value);
        runs_ = wind::goes_on(turbine_.rotor, turbine_.wind(scale_(t)), runs_); // a jump crosses nothing
        return done;
    }

  private:
    static wind::State rotor_state(std::span<double const> x) {
        wind::State out{};
        std::copy_n(x.begin(), out.size(), out.begin());
        return out;
    }
    [[nodiscard]] Complex given_kva(std::span<double const> x, double v) const {
        return within_rating(turbine_.power_kva(x[wind::kPower]), v, turbine_.converter_kva());
    }
    [[nodiscard]] Complex power(double, std::span<double const> x, double v) const override {
        return given_kva(x, v) / base_kva();
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        wind::Operation now = turbine_.operation(turbine_.wind(scale_(t)), runs_);
        if (!connected()) {
            now.limit_pu = 0;
        } else if (turbine_.generator == WindGenerator::full_converter) {
            now.taken_pu = x[wind::kPower];
        } else {
            now.taken_pu = given_kva(x, std::abs(v)).real() / turbine_.rated_kw;
        }
        wind::State slope{};
        wind::derivative(turbine_.rotor, now, rotor_state(x), slope);
        std::ranges::copy(slope, dx.begin());
    }
    WindTurbine turbine_;
    Scale scale_;
    bool runs_{true};
};

class WindPower final : public PowerModel {
  public:
    WindPower(WindTurbine const& turbine, Scale scale) : turbine_{turbine}, scale_{std::move(scale)} {}
    void start(double) override {
        wind_ = turbine_.wind(scale_(0));
        x_ = turbine_.start(wind_);
        runs_ = wind::goes_on(turbine_.rotor, wind_, true);
        until_ = 0;
    }
    Complex power_va(double t, double v, double h) override {
        // While it was out of service nobody asked, and nothing was taken from its generator.
        constexpr double kStep = 1e-3;
        while (t - h - until_ > kStep) {
            step(until_ + kStep, kStep, 0, true);
        }
        double const rating = turbine_.converter_kva();
        double const taken =
            turbine_.generator == WindGenerator::full_converter
                ? x_[wind::kPower]
                : within_rating(turbine_.power_kva(x_[wind::kPower]), v, rating).real() / turbine_.rated_kw;
        step(t, h, taken, false);
        return 1e3 * turbine_.power_kva(x_[wind::kPower]);
    }
    bool set(std::string_view quantity, double value) override { return turbine_.set(quantity, value); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return wind_signals(); }
    [[nodiscard]] double value(std::size_t signal) const override {
        return wind_value(turbine_, signal, x_, wind_, runs_);
    }

  private:
    /// One step of Heun's method to t.
    void step(double t, double h, double taken_pu, bool out_of_service) {
        until_ = t;
        wind_ = turbine_.wind(scale_(t));
        runs_ = wind::goes_on(turbine_.rotor, wind_, runs_);
        wind::Operation now = turbine_.operation(wind_, runs_);
        now.taken_pu = taken_pu;
        now.limit_pu = out_of_service ? 0 : now.limit_pu;
        wind::State first{}, second{}, there = x_;
        wind::derivative(turbine_.rotor, now, x_, first);
        for (std::size_t i = 0; i < wind::kStates; ++i) {
            there[i] += h * first[i];
        }
        wind::derivative(turbine_.rotor, now, there, second);
        for (std::size_t i = 0; i < wind::kStates; ++i) {
            x_[i] += h / 2 * (first[i] + second[i]);
        }
    }
    WindTurbine turbine_;
    Scale scale_;
    wind::State x_{};
    double wind_{0}, until_{0};
    bool runs_{true};
};

} // namespace

std::unique_ptr<PhasorInjection> WindTurbine::phasor(Surroundings const& around) const {
    return std::make_unique<WindInjection>(*this, around);
}

void WindTurbine::circuit(CircuitFace& face) const {
    face.converter(*this, converter_kva(), std::make_unique<WindPower>(*this, face.scale(scale)), ride_through);
}

} // namespace gridspace::sim
