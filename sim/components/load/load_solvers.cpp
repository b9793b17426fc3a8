// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/load/load.hpp"

#include <cmath>

/// A load in the phasor and in the waveform simulation.
namespace gridspace::sim {
namespace {

/// States (with a lag): p, q.
class LoadInjection final : public PowerInjection {
  public:
    LoadInjection(Load const& load, Surroundings const& around)
        : PowerInjection{Load::kKind, load.name, around.bus(load.bus), around.base_kva()}, load_{load},
          scale_{around.scale(load.scale)} {}
    [[nodiscard]] std::size_t states() const override { return load_.lag_s > 0 ? 2 : 0; }
    void start(double t, Complex v, Complex, std::span<double> x) override {
        if (!x.empty()) {
            Complex const s = demand(t, std::abs(v));
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
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override {
        return x.empty() ? demand(t, v) : Complex{x[0], x[1]};
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        if (!x.empty()) {
            Complex const s = demand(t, std::abs(v));
            dx[0] = (s.real() - x[0]) / load_.lag_s;
            dx[1] = (s.imag() - x[1]) / load_.lag_s;
        }
    }
    Load load_;
    Scale scale_;
};

class LoadPower : public PowerModel {
  public:
    LoadPower(Load const& load, Scale scale) : load_{load}, scale_{std::move(scale)} {}
    void start(double) override { lagged_ = {}; }
    bool set(std::string_view quantity, double value) override { return load_.set(quantity, value); }

  protected:
    [[nodiscard]] Load const& load() const { return load_; }
    [[nodiscard]] double scale(double t) const { return scale_(t); }
    /// What is drawn after `h` where `target` is wanted; of a phase, or together.
    Complex lag(Complex target, std::size_t phase, double h) {
        Complex& lagged = lagged_[phase];
        lagged = load_.lag_s > 0 && h > 0 ? lagged + (target - lagged) * (h / (load_.lag_s + h)) : target;
        return lagged;
    }

  private:
    Load load_;
    Scale scale_;
    std::array<Complex, 3> lagged_{};
};

/// Powers of a load beyond its star of impedances.
class BeyondStar final : public LoadPower {
  public:
    using LoadPower::LoadPower;
    Complex power_va(double t, double v, double h) override { return beyond(load().nominal_kva(), 0, t, v, h); }
    Complex phase_power_va(std::size_t phase, double t, double v, double h) override {
        return beyond(load().nominal_kva(phase), phase, t, v, h);
    }

  private:
    Complex beyond(Complex nominal, std::size_t phase, double t, double v, double h) {
        VoltagePower const factor = load().factor(v);
        double const k = scale(t);
        Complex const target{k * factor.p * nominal.real(), k * factor.q * nominal.imag()};
        return -1e3 * (lag(target, phase, h) - nominal * v * v);
    }
};

class RectifierPower final : public LoadPower {
  public:
    using LoadPower::LoadPower;
    Complex power_va(double t, double, double h) override {
        return -1e3 * lag(load().nominal_kva().real() * scale(t), 0, h);
    }
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
