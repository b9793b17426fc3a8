// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/supercapacitor/supercapacitor.hpp"

#include "sim/components/faces/converter.hpp"
#include "sim/components/faces/storage.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Supercapacitor::fields(Fields& f) {
    f.number("capacitance_f", capacitance_f, positive("capacitance of the bank, F", true));
    f.number("rated_voltage_v", rated_voltage_v, positive("charging stops exactly here", true));
    f.number("v_min_v", v_min_v, positive("discharging stops exactly here", true));
    f.number("v_start_v", v_start_v, positive("voltage of the capacitance at the start", true));
    f.number("rating_kva", rating_kva, positive("rated power of the converter", true));
    f.number("p_kw", p_kw, any("power into the network; negative: charging"));
    f.number("q_kvar", q_kvar, any("reactive power into the network"));
    f.number("esr_ohm", esr_ohm, not_negative("equivalent series resistance of the bank"));
    f.number("leakage_ohm", leakage_ohm, not_negative("resistance beside the capacitance; 0: no leakage"));
    f.number("i_max_a", i_max_a, not_negative("most current of the bank, each way; 0: no limit"));
    f.number("efficiency", efficiency, at_most_one("of the converter, each way"));
    f.reference("scale", scale, {.doc = "profile that multiplies p_kw"});
    describe_ride_through(f, ride_through);
    if (v_min_v >= rated_voltage_v && rated_voltage_v > 0) {
        f.error("v_min_v",
                fmt::format("'{}' has a lowest voltage of {} V, not below its rated {} V", name.name, v_min_v,
                            rated_voltage_v),
                "half of the rated voltage leaves a quarter of the energy");
    } else if (v_start_v > 0 && !(v_min_v <= v_start_v && v_start_v <= rated_voltage_v)) {
        f.error("v_start_v",
                fmt::format("'{}' starts at {} V, which is not between its v_min_v of {} V and its rated {} V",
                            name.name, v_start_v, v_min_v, rated_voltage_v),
                "begin within the limits of its voltage");
    }
    check_powers(f, name.name, p_kw, q_kvar, rating_kva);
}

double Supercapacitor::voltage_v(double soc) const {
    constexpr double kLeastPercent = 1e-10; // a power has a current only where there is a voltage
    return rated_voltage_v * std::sqrt(std::max(kLeastPercent, soc) / 100);
}

double Supercapacitor::asked_kw(double times) const {
    return beside_reactive(p_kw * times, q_kvar, rating_kva);
}

double Supercapacitor::current_a(double kw, double v, Limits at) const {
    double const p = 1e3 * power_of_store(kw, efficiency), square = v * v - 4 * esr_ohm * p;
    // The smaller root of R I^2 - V I + P = 0, in a form that holds without a resistance.
    double i = p == 0 ? 0 : square < 0 ? v / (2 * esr_ohm) : 2 * p / (v + std::sqrt(square));
    if (i_max_a > 0) {
        i = std::clamp(i, -i_max_a, i_max_a);
    }
    if (at.empty) {
        i = std::min(i, 0.0);
    }
    if (at.full) {
        i = std::max(i, leakage_ohm > 0 ? -v / leakage_ohm : 0.0);
    }
    return i;
}

double Supercapacitor::given_kw(double i, double v) const {
    double const of_bank = 1e-3 * (v - i * esr_ohm) * i;
    return of_bank > 0 ? of_bank * efficiency : of_bank / efficiency;
}

double Supercapacitor::soc_slope(double i, double v) const {
    double const leaks = leakage_ohm > 0 ? v / leakage_ohm : 0;
    return -100 * 2 * v * (i + leaks) / (capacitance_f * rated_voltage_v * rated_voltage_v);
}

Supercapacitor::Working Supercapacitor::working(double times, double soc, Limits at, double v) const {
    double const volts = voltage_v(soc), i = current_a(asked_kw(times), volts, at);
    Complex const wanted{given_kw(i, volts), q_kvar}, given = within_rating(wanted, v, rating_kva);
    return {wanted, given, given == wanted ? i : current_a(given.real(), volts, at)};
}

void Supercapacitor::power_flow(PowerFlowFace& face) const {
    Limits const at{v_start_v <= v_min_v, v_start_v >= rated_voltage_v};
    face.inject(bus, {given_kw(current_a(asked_kw(face.scale(scale)), v_start_v, at), v_start_v), q_kvar});
}

bool Supercapacitor::set(std::string_view quantity, double value) {
    (quantity == "p_kw" ? p_kw : q_kvar) = value;
    return true;
}

namespace {

/// Signals other than its powers.
enum class BankSignal : std::size_t { soc, voltage, current };
std::vector<SignalDef> bank_signals() {
    return {{"soc_percent", "%"}, {"voltage_v", "V"}, {"current_a", "A"}};
}

/// State: state of charge (%).
class SupercapacitorInjection final : public PowerInjection {
  public:
    SupercapacitorInjection(Supercapacitor const& bank, Surroundings const& around)
        : PowerInjection{Supercapacitor::kKind, bank.name, around.bus(bank.bus), around.base_kva()}, bank_{bank},
          limits_{bank.soc_percent(bank.v_min_v), 100}, scale_{around.scale(bank.scale)} {}
    [[nodiscard]] std::size_t states() const override { return 1; }
    void start(double, Complex, Complex, std::span<double> x) override {
        x[0] = bank_.soc_percent(bank_.v_start_v);
        limits_.start(x[0]);
    }
    [[nodiscard]] bool has_event() const override { return true; }
    [[nodiscard]] double event(double, std::span<double const> x) const override {
        return limits_.event(x[0], true, true); // leakage takes it down whatever it is asked
    }
    void on_event(std::span<double> x) override { limits_.on_event(x[0]); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return powers_and(bank_signals()); }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        if (signal < 2) {
            return PowerInjection::value(signal, t, x, v);
        }
        switch (static_cast<BankSignal>(signal - 2)) {
        case BankSignal::soc:
            return x[0];
        case BankSignal::voltage:
            return bank_.voltage_v(x[0]);
        case BankSignal::current:
            break;
        }
        return current_a(t, x, v);
    }
    bool set(double, std::string_view quantity, double value) override { return bank_.set(quantity, value); }

  private:
    [[nodiscard]] Supercapacitor::Limits at() const { return {limits_.empty(), limits_.full()}; }
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override {
        return bank_.working(scale_(t), x[0], at(), v).given_kva / base_kva();
    }
    [[nodiscard]] double current_a(double t, std::span<double const> x, Complex v) const {
        return connected() ? bank_.working(scale_(t), x[0], at(), std::abs(v)).current_a : 0;
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        dx[0] = bank_.soc_slope(current_a(t, x, v), bank_.voltage_v(x[0]));
    }
    Supercapacitor bank_;
    StoreLimits limits_;
    Scale scale_;
};

class SupercapacitorPower final : public PowerModel {
  public:
    SupercapacitorPower(Supercapacitor const& bank, Scale scale) : bank_{bank}, scale_{std::move(scale)} {}
    void start(double) override {
        soc_percent_ = bank_.soc_percent(bank_.v_start_v);
        current_a_ = 0;
    }
    Complex power_va(double t, double v, double h) override {
        double const lowest = bank_.soc_percent(bank_.v_min_v);
        auto const now = bank_.working(scale_(t), soc_percent_, {soc_percent_ <= lowest, soc_percent_ >= 100}, v);
        current_a_ = now.current_a;
        double const next = soc_percent_ + bank_.soc_slope(current_a_, bank_.voltage_v(soc_percent_)) * h;
        // Leakage alone takes it below the voltage at which discharging stops.
        bool const stops = current_a_ > 0 && next < lowest;
        soc_percent_ = stops ? lowest : std::clamp(next, 0.0, 100.0);
        return 1e3 * now.wanted_kva;
    }
    void disconnect() override { current_a_ = 0; }
    bool set(std::string_view quantity, double value) override { return bank_.set(quantity, value); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return bank_signals(); }
    [[nodiscard]] double value(std::size_t signal) const override {
        switch (static_cast<BankSignal>(signal)) {
        case BankSignal::soc:
            return soc_percent_;
        case BankSignal::voltage:
            return bank_.voltage_v(soc_percent_);
        case BankSignal::current:
            break;
        }
        return current_a_;
    }

  private:
    Supercapacitor bank_;
    Scale scale_;
    double soc_percent_{0}, current_a_{0};
};

} // namespace

std::unique_ptr<PhasorInjection> Supercapacitor::phasor(Surroundings const& around) const {
    return std::make_unique<SupercapacitorInjection>(*this, around);
}

void Supercapacitor::circuit(CircuitFace& face) const {
    face.converter(*this, rating_kva, std::make_unique<SupercapacitorPower>(*this, face.scale(scale)), ride_through);
}

} // namespace gridspace::sim
