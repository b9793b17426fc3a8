// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/battery/battery.hpp"

#include "sim/components/faces/converter.hpp"
#include "sim/components/faces/storage.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Battery::fields(Fields& f) {
    f.number("capacity_kwh", capacity_kwh, positive("energy of the cells", true));
    f.number("rating_kva", rating_kva, positive("rated power of the converter", true));
    f.number("p_kw", p_kw, any("power into the network; negative: charging"));
    f.number("q_kvar", q_kvar, any("reactive power into the network"));
    f.number("efficiency", efficiency, at_most_one("of the converter, each way"));
    f.number("soc_start_percent", soc_start_percent, percent("state of charge at the start"));
    f.number("soc_min_percent", soc_min_percent, percent("discharging stops exactly here"));
    f.number("soc_max_percent", soc_max_percent, percent("charging stops exactly here"));
    f.reference("scale", scale, {.doc = "profile that multiplies p_kw"});
    f.choice<BatteryControl>(
        "control", control,
        {{"grid_following", BatteryControl::grid_following}, {"grid_forming", BatteryControl::grid_forming}},
        {.doc = "gives its powers to the voltage that is there, or is a voltage and holds an island"});
    describe_ride_through(f, ride_through);
    if (forms() && ride_through) {
        f.error("ride_through", fmt::format("'{}' is grid-forming: it holds the voltage itself", name.name),
                "leave it out");
    }
    bool given = false;
    f.object("grid_forming", {.doc = "of a virtual synchronous machine, p.u. on rating_kva"}, [&](Fields& g) {
        given = true;
        forming.fields(g);
    });
    if (given && !forms()) {
        f.error("grid_forming", fmt::format("'{}' is grid-following", name.name), "add `control: grid_forming`");
    }
    if (forms() && q_kvar != 0) {
        f.error("q_kvar",
                fmt::format("'{}' is grid-forming: it gives the reactive power that its voltage needs", name.name),
                "leave it out, and give a voltage_setpoint_pu");
    }
    if (forms() && !scale.name.empty()) {
        f.error("scale", fmt::format("'{}' is grid-forming: it gives the power that the grid needs", name.name),
                "leave it out, and set its p_kw by events");
    }
    if (!(soc_min_percent <= soc_start_percent && soc_start_percent <= soc_max_percent)) {
        f.error("soc_start_percent", fmt::format("'{}' starts at {} %, which is not between {} % and {} %", name.name,
                                                 soc_start_percent, soc_min_percent, soc_max_percent));
    }
    check_powers(f, name.name, p_kw, q_kvar, rating_kva);
}

double Battery::asked_kw(double times) const {
    return beside_reactive(p_kw * times, q_kvar, rating_kva);
}

double Battery::asked_kw(double times, double soc_percent) const {
    double const p = asked_kw(times);
    bool const spent = p > 0 ? soc_percent <= soc_min_percent : soc_percent >= soc_max_percent;
    return spent ? 0 : p;
}

void Battery::power_flow(PowerFlowFace& face) const {
    if (forms()) {
        face.regulate(
            bus,
            {.p_kw = p_kw, .voltage_pu = forming.voltage_setpoint_pu, .rating_kva = rating_kva, .keeps_alive = true});
    } else {
        face.inject(bus, {asked_kw(face.scale(scale), soc_start_percent), q_kvar});
    }
}

Complex Battery::sequence_pu(Sequence, Surroundings const& around) const {
    return forms() ? rating_kva / around.base_kva() / Complex{forming.r_pu, forming.x_pu} : Complex{};
}

bool Battery::set(std::string_view quantity, double value) {
    bool const of_follower = quantity == "q_kvar", of_both = quantity == "p_kw";
    if (!of_both && of_follower == forms()) {
        return false; // refuses() says why
    }
    (quantity == "p_kw"                  ? p_kw
     : quantity == "q_kvar"              ? q_kvar
     : quantity == "voltage_setpoint_pu" ? forming.voltage_setpoint_pu
     : quantity == "droop_percent"       ? forming.droop_percent
                                         : frequency_setpoint_hz) = value;
    return true;
}

double Battery::value(std::string_view quantity, Surroundings const& around) const {
    return quantity == "p_kw"                  ? p_kw
           : quantity == "q_kvar"              ? q_kvar
           : quantity == "voltage_setpoint_pu" ? forming.voltage_setpoint_pu
           : quantity == "droop_percent"       ? forming.droop_percent
           : frequency_setpoint_hz > 0         ? frequency_setpoint_hz
                                               : around.frequency_hz();
}

namespace {
constexpr Refusal kFollows{"this battery is grid-following", "give it `control: grid_forming`"};
} // namespace

std::optional<Refusal> Battery::refuses(std::string_view quantity, Surroundings const&, bool) const {
    if (quantity == "p_kw") {
        return {};
    }
    if (quantity == "q_kvar") {
        return forms() ? std::optional{Refusal{"a grid-forming battery gives the reactive power that its voltage needs",
                                               "set its voltage_setpoint_pu"}}
                       : std::nullopt;
    }
    return forms() ? std::nullopt : std::optional{kFollows};
}

std::optional<Refusal> Battery::refuses_mode(std::string_view mode, Surroundings const&) const {
    if (!forms()) {
        return kFollows;
    }
    return mode == "isochronous" && forming.integral_ki == 0
               ? std::optional{Refusal{"its control has no integral", "give its `grid_forming` an `integral_ki`"}}
               : std::nullopt;
}

double Battery::soc_slope(double given_kw) const {
    return -100 * power_of_store(given_kw, efficiency) / (capacity_kwh * 3600);
}

namespace {

/// State: state of charge (%).
class BatteryInjection final : public PowerInjection {
  public:
    BatteryInjection(Battery const& battery, Surroundings const& around)
        : PowerInjection{Battery::kKind, battery.name, around.bus(battery.bus), around.base_kva()}, battery_{battery},
          limits_{battery.soc_min_percent, battery.soc_max_percent}, scale_{around.scale(battery.scale)} {}
    [[nodiscard]] std::size_t states() const override { return 1; }
    void start(double, Complex, Complex, std::span<double> x) override {
        x[0] = battery_.soc_start_percent;
        limits_.start(x[0]);
    }
    [[nodiscard]] bool has_event() const override { return true; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override {
        double const p = connected() ? battery_.asked_kw(scale_(t)) : 0;
        return limits_.event(x[0], p > 0, p < 0);
    }
    void on_event(std::span<double> x) override { limits_.on_event(x[0]); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return powers_and({{"soc_percent", "%"}}); }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        return signal == 2 ? x[0] : PowerInjection::value(signal, t, x, v);
    }
    bool set(double, std::string_view quantity, double value) override { return battery_.set(quantity, value); }

  private:
    [[nodiscard]] Complex power(double t, std::span<double const>, double v) const override {
        double const p = battery_.asked_kw(scale_(t));
        bool const spent = p > 0 ? limits_.empty() : limits_.full();
        return within_rating({spent ? 0 : p, battery_.q_kvar}, v, battery_.rating_kva) / base_kva();
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        dx[0] = battery_.soc_slope(PowerInjection::value(0, t, x, v));
    }
    Battery battery_;
    StoreLimits limits_; ///< at one of them it gives, or takes, nothing
    Scale scale_;
};

class BatteryPower final : public PowerModel {
  public:
    BatteryPower(Battery const& battery, Scale scale) : battery_{battery}, scale_{std::move(scale)} {}
    void start(double) override { soc_percent_ = battery_.soc_start_percent; }
    Complex power_va(double t, double, double h) override {
        double const p_kw = battery_.asked_kw(scale_(t), soc_percent_);
        soc_percent_ =
            std::clamp(soc_percent_ + battery_.soc_slope(p_kw) * h, battery_.soc_min_percent, battery_.soc_max_percent);
        return {1e3 * p_kw, 1e3 * battery_.q_kvar};
    }
    bool set(std::string_view quantity, double value) override { return battery_.set(quantity, value); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return {{"soc_percent", "%"}}; }
    [[nodiscard]] double value(std::size_t) const override { return soc_percent_; }

  private:
    Battery battery_;
    Scale scale_;
    double soc_percent_{0};
};

} // namespace

std::unique_ptr<PhasorInjection> Battery::phasor(Surroundings const& around) const {
    if (forms()) {
        return forming::phasor(*this, around);
    }
    return std::make_unique<BatteryInjection>(*this, around);
}

void Battery::circuit(CircuitFace& face) const {
    if (forms()) {
        face.norton(*this, forming::waveform(*this, face));
        return;
    }
    face.converter(*this, rating_kva, std::make_unique<BatteryPower>(*this, face.scale(scale)), ride_through);
}

} // namespace gridspace::sim
