// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/battery/battery.hpp"
#include "sim/components/battery/grid_forming.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

/// A grid-forming converter in the phasor simulation: its filter without transients.
namespace gridspace::sim::forming {
namespace {

class FormingInjection final : public PhasorInjection {
  public:
    FormingInjection(Battery const& battery, Surroundings const& around)
        : PhasorInjection{around.bus(battery.bus)}, control_{battery, around.omega()},
          to_network_{battery.rating_kva / around.base_kva()}, base_hz_{around.frequency_hz()} {}

    [[nodiscard]] std::size_t states() const override { return kStates; }
    void start(double, Complex v, Complex s, std::span<double> x) override {
        Complex const i = v == Complex{} ? Complex{} : std::conj(s / to_network_ / v);
        State const start = control_.steady_state(v, i);
        std::copy(start.begin(), start.end(), x.begin());
    }
    [[nodiscard]] Result<void> check_start(std::span<double const>) const override { return control_.check_start(); }
    Complex flow(double t, std::span<double const> states, Complex v, std::span<double> dx) const override {
        if (!connected()) {
            std::fill(dx.begin(), dx.end(), 0.0);
            return {};
        }
        State const x = state_of(states);
        Complex const drive = std::polar(x[kEmf], x[kAngle]) - v;
        double const share = control_.share(drive);
        Complex const i = share * drive / control_.impedance(), s = v * std::conj(i);
        State d{};
        control_.derivative(x, {s.real(), s.imag(), std::abs(v), (1 - share) * std::abs(drive)}, t, d);
        std::copy(d.begin(), d.end(), dx.begin());
        return i * to_network_;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        std::string const prefix = "battery." + control_.name() + ".";
        std::vector<SignalDef> out{{prefix + "p_kw", "kW"}, {prefix + "q_kvar", "kvar"}};
        for (SignalDef const& own : forming::signals()) {
            out.push_back({prefix + own.name, own.unit});
        }
        return out;
    }
    [[nodiscard]] double value(std::size_t index, double, std::span<double const> states, Complex v) const override {
        State const x = state_of(states);
        Complex const drive = connected() ? std::polar(x[kEmf], x[kAngle]) - v : Complex{};
        double const share = control_.share(drive);
        Complex const s = v * std::conj(share * drive / control_.impedance()) * control_.rating_kva;
        return index == 0 ? s.real() : index == 1 ? s.imag() : forming::signal(index - 2, x, base_hz_, share);
    }
    [[nodiscard]] std::optional<Rotor> rotor(std::span<double const> x) const override {
        return Rotor{control_.data.inertia_h_s * control_.rating_kva, base_hz_ * (1 + x[kSpeed])};
    }
    bool set(double, std::string_view quantity, double value) override { return control_.change(quantity, value); }
    void set_mode(std::string_view mode) override { control_.mode(mode); }
    void resume(double t, Complex v, std::span<double> states) override {
        State x = state_of(states);
        control_.resume(t, v, x);
        std::copy(x.begin(), x.end(), states.begin());
    }

  private:
    static State state_of(std::span<double const> x) {
        State s;
        std::copy_n(x.begin(), s.size(), s.begin());
        return s;
    }
    Control control_;
    double to_network_; ///< own rating over the network's base
    double base_hz_;
};

} // namespace

std::unique_ptr<PhasorInjection> phasor(Battery const& battery, Surroundings const& around) {
    return std::make_unique<FormingInjection>(battery, around);
}

} // namespace gridspace::sim::forming
