// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/electrolyser/electrolyser.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

/// An electrolyser in the phasor and in the waveform simulation.
namespace gridspace::sim {
namespace {

/// States: share of rated power, hydrogen (g). While it ramps, its slope is constant, and that it is there is an event;
/// else it follows with a short lag what its profile wants, and that this is too fast for it is an event.
class ElectrolyserInjection final : public PowerInjection {
  public:
    ElectrolyserInjection(Electrolyser const& electrolyser, Surroundings const& around)
        : PowerInjection{Electrolyser::kKind, electrolyser.name, around.bus(electrolyser.bus), around.base_kva()},
          electrolyser_{electrolyser}, scale_{around.scale(electrolyser.scale)} {}
    [[nodiscard]] std::size_t states() const override { return 2; }
    void start(double t, Complex, Complex, std::span<double> x) override {
        x[0] = target(t);
        x[1] = 0;
    }
    [[nodiscard]] bool has_event() const override { return true; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override {
        double const ahead = target(t) - x[0];
        return !connected()         ? 1
               : law_ == Law::rises ? ahead
               : law_ == Law::falls ? -ahead
                                    : std::min(up() * kFollowingS - ahead, down() * kFollowingS + ahead);
    }
    void on_event(std::span<double>) override { arrived_ = law_ != Law::follows; }
    void decide(double t, std::span<double> x) override {
        if (!connected()) {
            x[0] = 0; // from where it ramps when it is back
        }
        constexpr double kThere = 1e-6;
        double const ahead = target(t) - x[0];
        bool const arrived = std::exchange(arrived_, false) && std::abs(ahead) < kThere;
        if (arrived) {
            x[0] = target(t);
        }
        // Half of what would be an event: where one was found, rounding does not matter.
        law_ = arrived                             ? Law::follows
               : ahead > up() * kFollowingS / 2    ? Law::rises
               : ahead < -down() * kFollowingS / 2 ? Law::falls
                                                   : Law::follows;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return powers_and(Electrolyser::signals()); }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        return signal < 2 ? PowerInjection::value(signal, t, x, v)
                          : electrolyser_.signal(signal - 2, given(t, x, std::abs(v)), x[1]);
    }
    bool set(double, std::string_view quantity, double value) override { return electrolyser_.set(quantity, value); }

  private:
    enum class Law { follows, rises, falls };
    static constexpr double kFollowingS = 0.01;

    [[nodiscard]] double up() const { return 1 / electrolyser_.ramp_up_s; }
    [[nodiscard]] double down() const { return 1 / electrolyser_.ramp_down_s; }
    [[nodiscard]] double target(double t) const { return electrolyser_.target(scale_(t)); }
    [[nodiscard]] Complex wanted_kva(double t, std::span<double const> x) const {
        return electrolyser_.drawn_kva(x[0], law_ == Law::follows && target(t) == 0);
    }
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const override {
        Complex const wanted = wanted_kva(t, x);
        return wanted * (electrolyser_.let_through(wanted, v) / base_kva());
    }
    /// Share of rated power that the stack gets.
    [[nodiscard]] double given(double t, std::span<double const> x, double v) const {
        return connected() ? std::max(0.0, x[0]) * electrolyser_.let_through(wanted_kva(t, x), v) : 0;
    }
    void slopes(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        double const following = std::clamp((target(t) - x[0]) / kFollowingS, -down(), up());
        dx[0] = !connected() ? 0 : law_ == Law::rises ? up() : law_ == Law::falls ? -down() : following;
        dx[1] = electrolyser_.stack.hydrogen_g_per_s(electrolyser_.current_a(given(t, x, std::abs(v))));
    }
    Electrolyser electrolyser_;
    Scale scale_;
    Law law_{Law::follows};
    bool arrived_{false};
};

class ElectrolyserPower final : public PowerModel {
  public:
    ElectrolyserPower(Electrolyser const& electrolyser, Scale scale)
        : electrolyser_{electrolyser}, scale_{std::move(scale)} {}
    void start(double) override {
        share_ = electrolyser_.target(scale_(0));
        give(share_);
        hydrogen_g_ = 0;
    }
    Complex power_va(double t, double v, double h) override {
        double const target = electrolyser_.target(scale_(t));
        share_ += std::clamp(target - share_, -h / electrolyser_.ramp_down_s, h / electrolyser_.ramp_up_s);
        Complex const wanted = electrolyser_.drawn_kva(share_, target == 0 && share_ == 0);
        give(share_ * electrolyser_.let_through(wanted, v));
        hydrogen_g_ += g_per_s_ * h;
        return -1e3 * wanted;
    }
    void disconnect() override {
        share_ = 0;
        give(0);
    }
    bool set(std::string_view quantity, double value) override { return electrolyser_.set(quantity, value); }
    [[nodiscard]] std::vector<SignalDef> signals() const override { return Electrolyser::signals(); }
    [[nodiscard]] double value(std::size_t signal) const override {
        return electrolyser_.signal(signal, given_, hydrogen_g_);
    }

  private:
    /// What the stack gets. Most steps change nothing: then its curve is not solved anew.
    void give(double share) {
        if (share != given_) {
            given_ = share;
            g_per_s_ = electrolyser_.stack.hydrogen_g_per_s(electrolyser_.current_a(share));
        }
    }
    Electrolyser electrolyser_;
    Scale scale_;
    double share_{0}, given_{0}, g_per_s_{0}, hydrogen_g_{0};
};

} // namespace

std::unique_ptr<PhasorInjection> Electrolyser::phasor(Surroundings const& around) const {
    return std::make_unique<ElectrolyserInjection>(*this, around);
}

void Electrolyser::circuit(CircuitFace& face) const {
    face.converter(*this, rating_kva(), std::make_unique<ElectrolyserPower>(*this, face.scale(scale)));
}

} // namespace gridspace::sim
