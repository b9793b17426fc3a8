// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/load/load.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>

/// A load in the phasor and in the waveform simulation.
namespace gridspace::sim {
namespace {

/// States (with a lag): p, q, as at voltages where the load follows its model. What a low voltage does to it needs no
/// time.
class LoadInjection final : public PowerInjection {
  public:
    LoadInjection(Load const& load, Surroundings const& around)
        : PowerInjection{Load::kKind, load.name, around.bus(load.bus), around.base_kva()}, load_{load},
          scale_{around.scale(load.scale)} {}
    [[nodiscard]] std::size_t states() const override { return load_.lag_s > 0 ? 2 : 0; }
    void start(double t, Complex v, Complex, std::span<double> x) override {
        if (!x.empty()) {
            Complex const s = demand(t, std::max(std::abs(v), model_holds_from()));
            x[0] = s.real();
            x[1] = s.imag();
        }
    }
    bool set(double, std::string_view quantity, double value) override { return load_.set(quantity, value); }

  private:
    [[nodiscard]] Complex demand(double t, double v) const {
        double const k = scale_(t) / base_kva();
        VoltagePower const f = load_.factor(v);
        Complex const nominal = load_.nominal_kva();
        return {nominal.real() * k * f.p, nominal.imag() * k * f.q};
    }
    /// Below, a load is an impedance, and a converter has its most current, p.u.
    [[nodiscard]] double model_holds_from() const {
        return load_.model == LoadModel::dc_constant_power ? 1 / kConverterOverload : kFloorPu;
    }
    /// What is drawn at this voltage of the power of the states.
    [[nodiscard]] double share(double v) const {
        double const of_floor = std::min(v / model_holds_from(), 1.0);
        return load_.model == LoadModel::dc_constant_power ? of_floor : of_floor * of_floor;
    }
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override {
        return x.empty() ? demand(t, v) : Complex{x[0], x[1]} * share(v);
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        if (!x.empty()) {
            Complex const s = demand(t, std::max(std::abs(v), model_holds_from()));
            dx[0] = (s.real() - x[0]) / load_.lag_s;
            dx[1] = (s.imag() - x[1]) / load_.lag_s;
        }
    }
    Load load_;
    Scale scale_;
};

class LoadPower : public PowerModel {
  public:
    LoadPower(Load const& load, Scale scale)
        : nominal_{load.nominal_kva()}, lag_s_{load.lag_s}, constant_power_{load.model == LoadModel::constant_power},
          scale_{std::move(scale)}, load_{load} {}
    void start(double) override { lagged_ = {}; }
    bool set(std::string_view quantity, double value) override {
        bool const known = load_.set(quantity, value);
        nominal_ = load_.nominal_kva();
        return known;
    }

  protected:
    [[nodiscard]] Load const& load() const { return load_; }
    [[nodiscard]] Complex nominal_kva() const { return nominal_; }
    [[nodiscard]] VoltagePower factor(double v) const {
        return constant_power_ && v >= kFloorPu ? VoltagePower{1, 1, 0, 0} : load_.factor(v);
    }
    [[nodiscard]] double scale(double t) const { return scale_(t); }
    /// What is drawn after `h` where `target` is wanted; of a phase, or together.
    Complex lag(Complex target, std::size_t phase, double h) {
        Complex& lagged = lagged_[phase];
        lagged = lag_s_ > 0 && h > 0 ? lagged + (target - lagged) * (h / (lag_s_ + h)) : target;
        return lagged;
    }

  private:
    // What a step reads stands together, and before the rest of the load.
    Complex nominal_;
    double lag_s_;
    bool constant_power_; ///< above the floor of the voltage
    std::array<Complex, 3> lagged_{};
    Scale scale_;
    Load load_;
};

/// Powers of a load beyond its star of impedances.
class BeyondStar final : public LoadPower {
  public:
    using LoadPower::LoadPower;
    Complex power_va(double t, double v, double h) override { return beyond(nominal_kva(), 0, t, v, h); }
    Complex phase_power_va(std::size_t phase, double t, double v, double h) override {
        return beyond(load().nominal_kva(phase), phase, t, v, h);
    }

  private:
    Complex beyond(Complex nominal, std::size_t phase, double t, double v, double h) {
        VoltagePower const f = factor(v);
        double const k = scale(t);
        Complex const target{k * f.p * nominal.real(), k * f.q * nominal.imag()};
        return -1e3 * (lag(target, phase, h) - nominal * v * v);
    }
};

class RectifierPower final : public LoadPower {
  public:
    using LoadPower::LoadPower;
    Complex power_va(double t, double, double h) override { return -1e3 * lag(nominal_kva().real() * scale(t), 0, h); }
};

} // namespace

std::unique_ptr<PhasorInjection> Load::phasor(Surroundings const& around) const {
    return std::make_unique<LoadInjection>(*this, around);
}

void Load::circuit(CircuitFace& face) const {
    if (model == LoadModel::dc_constant_power) {
        face.converter(*this, std::abs(p_kw), std::make_unique<RectifierPower>(*this, face.scale(scale)));
        return;
    }
    if (phase_p_kw.empty()) {
        face.star(*this);
    } else {
        face.star_by_phase(*this, {nominal_kva(0), nominal_kva(1), nominal_kva(2)});
    }
    bool const constant_impedance = model == LoadModel::constant_impedance || model == LoadModel::dc_resistive;
    if (!constant_impedance || !scale.empty() || lag_s > 0) {
        face.beyond_star(*this, std::make_unique<BeyondStar>(*this, face.scale(scale)));
    }
}

} // namespace gridspace::sim
