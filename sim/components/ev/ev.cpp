// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/ev/ev.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Ev::fields(Fields& f) {
    f.number("capacity_kwh", capacity_kwh, positive("energy of the battery", true));
    f.number("battery_v", battery_v, positive("voltage of the battery", true));
    f.number("max_current_a", max_current_a, positive("most battery current", true));
    f.number("efficiency", efficiency, at_most_one("battery power over power from the grid"));
    f.number("soc_start_percent", soc_start_percent, percent("state of charge at the start", true));
    f.number("soc_stop_percent", soc_stop_percent, percent("charging stops exactly here"));
    f.number("current_lag_s", current_lag_s, not_negative("response time of the converter"));
    if (soc_stop_percent < soc_start_percent) {
        f.error("soc_stop_percent", fmt::format("'{}' stops at {} %, below its start at {} %", name.name,
                                                soc_stop_percent, soc_start_percent));
    }
}

double Ev::reference_a(double wanted_a) const {
    return std::clamp(wanted_a, 0.0, max_current_a);
}

namespace {

/// States: battery current (A), state of charge (%). That it is full is an event.
class EvInjection final : public PhasorInjection {
  public:
    EvInjection(Ev const& ev, Surroundings const& around)
        : PhasorInjection{around.bus(ev.bus)}, ev_{ev}, base_kva_{around.base_kva()} {}
    [[nodiscard]] std::size_t states() const override { return 2; }
    void start(double, Complex, Complex, std::span<double> x) override {
        x[0] = 0;
        x[1] = ev_.soc_start_percent;
        full_ = ev_.full_at_start();
    }
    Complex flow(double, std::span<double const> x, Complex v, std::span<double> dx) const override {
        double const target = charging() ? reference_a_ : 0;
        // Without a lag the state still exists; a microsecond response is an ideal converter at any useful step.
        dx[0] = (target - x[0]) / std::max(ev_.current_lag_s, 1e-6);
        double const current = charging() ? x[0] : 0;
        dx[1] = ev_.charge_percent(current, 1);
        return consumed(within_rating({kw(current) / base_kva_, 0}, std::abs(v), kw(ev_.max_current_a) / base_kva_), v);
    }
    [[nodiscard]] bool has_event() const override { return !full_; }
    [[nodiscard]] double event(double, std::span<double const> x) const override { return ev_.soc_stop_percent - x[1]; }
    void on_event(std::span<double> x) override {
        full_ = true;
        x[0] = 0;
        x[1] = ev_.soc_stop_percent;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        std::string const prefix = "ev." + ev_.name.name;
        return {{prefix + ".soc_percent", "%"},
                {prefix + ".current_a", "A"},
                {prefix + ".reference_a", "A"},
                {prefix + ".p_kw", "kW"}};
    }
    [[nodiscard]] double value(std::size_t signal, double, std::span<double const> x, Complex v) const override {
        double const current = charging() ? x[0] : 0;
        double const values[] = {x[1], current, reference_a_,
                                 within_rating({kw(current), 0}, std::abs(v), kw(ev_.max_current_a)).real()};
        return values[signal];
    }
    bool set(double, std::string_view, double current_a) override {
        reference_a_ = ev_.reference_a(current_a);
        return true;
    }

  private:
    [[nodiscard]] bool charging() const { return connected() && !full_; }
    [[nodiscard]] double kw(double current_a) const { return ev_.power_w(current_a) / 1e3; }
    Ev ev_;
    double base_kva_;
    double reference_a_{0};
    bool full_{false};
};

class EvPower final : public PowerModel {
  public:
    explicit EvPower(Ev const& ev) : ev_{ev} {}
    void start(double) override {
        current_a_ = reference_a_ = 0;
        soc_percent_ = ev_.soc_start_percent;
        full_ = ev_.full_at_start();
    }
    Complex power_va(double, double, double h) override {
        if (h > 0 && !full_) {
            charge(h);
        }
        return {-ev_.power_w(current_a_), 0};
    }
    void disconnect() override { current_a_ = 0; }
    bool set(std::string_view, double current_a) override {
        reference_a_ = ev_.reference_a(current_a);
        return true;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        return {{"soc_percent", "%"}, {"current_a", "A"}, {"reference_a", "A"}};
    }
    [[nodiscard]] double value(std::size_t signal) const override {
        double const values[] = {soc_percent_, current_a_, reference_a_};
        return values[signal];
    }

  private:
    void charge(double h) {
        current_a_ += (reference_a_ - current_a_) * (h / (ev_.current_lag_s + h));
        soc_percent_ += ev_.charge_percent(current_a_, h);
        if (soc_percent_ >= ev_.soc_stop_percent) {
            soc_percent_ = ev_.soc_stop_percent;
            current_a_ = 0;
            full_ = true;
        }
    }
    Ev ev_;
    double current_a_{0}, reference_a_{0}, soc_percent_{0};
    bool full_{false};
};

} // namespace

std::unique_ptr<PhasorInjection> Ev::phasor(Surroundings const& around) const {
    return std::make_unique<EvInjection>(*this, around);
}

void Ev::circuit(CircuitFace& face) const {
    face.converter(*this, power_w(max_current_a) / 1e3, std::make_unique<EvPower>(*this));
}

} // namespace gridspace::sim
