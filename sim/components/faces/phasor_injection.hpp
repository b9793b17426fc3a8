// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/circuit/norton.hpp"
#include "sim/components/faces/element.hpp"
#include "sim/engine/engine.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace gridspace::sim {

/// Something at one bus of the phasor network: states x with x' = f(t, x, v), and the current it injects, g(t, x, v).
/// p.u. on the network's base, phase reference turning at nominal frequency. Functions of their arguments only.
class PhasorInjection {
  public:
    explicit PhasorInjection(std::size_t bus) : bus_{bus} {}
    virtual ~PhasorInjection() = default;

    [[nodiscard]] std::size_t bus() const { return bus_; }
    [[nodiscard]] virtual std::size_t states() const { return 0; }
    /// Initial states in the steady state with bus voltage `v`, where the power flow found that it gives `s`.
    virtual void start(double /*t*/, Complex /*v*/, Complex /*s*/, std::span<double> /*x*/) {}
    /// Whether it can start so; the error names the element.
    [[nodiscard]] virtual Result<void> check_start(std::span<double const> /*x*/) const { return {}; }
    /// Writes x' to `dx` and returns the injected current.
    virtual Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const = 0;

    /// An event function: the solver stops where it crosses zero from above and calls on_event.
    [[nodiscard]] virtual bool has_event() const { return false; }
    [[nodiscard]] virtual double event(double /*t*/, std::span<double const> /*x*/) const { return 1; }
    virtual void on_event(std::span<double> /*x*/) {}
    /// The solver starts anew at t: after an event, a command, or a quantity that was set. Which of its laws holds from
    /// here on is decided now.
    virtual void decide(double /*t*/, std::span<double> /*x*/) {}

    /// Signals of this injection, and their values.
    [[nodiscard]] virtual std::vector<SignalDef> signals() const { return {}; }
    [[nodiscard]] virtual double value(std::size_t signal, double t, std::span<double const> x, Complex v) const = 0;

    [[nodiscard]] virtual std::optional<Rotor> rotor(std::span<double const> /*x*/) const { return {}; }
    /// Changes a quantity from t on; false when it cannot have this value.
    virtual bool set(double /*t*/, std::string_view /*quantity*/, double /*value*/) { return false; }
    /// One of the modes of its kind, from now on.
    virtual void set_mode(std::string_view /*mode*/) {}
    /// Back from standing by at a bus voltage v (0: dead).
    virtual void resume(double /*t*/, Complex /*v*/, std::span<double> /*x*/) {}
    void connect(bool connected) { connected_ = connected; }
    void stand_by(bool on) { stands_by_ = on; }
    /// In service, and not standing by.
    [[nodiscard]] bool connected() const { return connected_ && !stands_by_; }

  private:
    std::size_t bus_;
    bool connected_{true}, stands_by_{false};
};

/// Current into the network of something that consumes power s at voltage v. At a dead bus nothing flows.
inline Complex consumed(Complex s, Complex v) {
    return std::norm(v) < 1e-12 ? Complex{} : -std::conj(s / v);
}

/// An injection that is a power, as a function of time, states and voltage: in the direction in which its kind counts.
/// Signals: p_kw, q_kvar.
class PowerInjection : public PhasorInjection {
  public:
    PowerInjection(Kind const& kind, Ref const& name, std::size_t bus, double base_kva)
        : PhasorInjection{bus}, prefix_{std::string{kind.prefix} + "." + name.name}, feeds_{kind.feeds},
          base_kva_{base_kva} {}
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override {
        slopes(t, x, v, dx);
        Complex const s = connected() ? power(t, x, std::abs(v)) : Complex{};
        return consumed(feeds_ ? -s : s, v);
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        return {{prefix_ + ".p_kw", "kW"}, {prefix_ + ".q_kvar", "kvar"}};
    }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override {
        Complex const s = connected() ? power(t, x, std::abs(v)) : Complex{};
        return (signal == 0 ? s.real() : s.imag()) * base_kva_;
    }

  protected:
    /// Power at |v|, p.u., while it is connected.
    [[nodiscard]] virtual Complex power(double t, std::span<double const> x, double v) const = 0;
    /// The slopes of its states.
    virtual void slopes(double /*t*/, std::span<double const> /*x*/, Complex /*v*/, std::span<double> /*dx*/) const {}
    [[nodiscard]] double base_kva() const { return base_kva_; }
    /// Its powers, and behind them signals of its own, whose names are without its prefix.
    [[nodiscard]] std::vector<SignalDef> powers_and(std::vector<SignalDef> own) const {
        auto out = PowerInjection::signals();
        for (SignalDef& signal : own) {
            signal.name.insert(0, prefix_ + ".");
            out.push_back(std::move(signal));
        }
        return out;
    }

  private:
    std::string prefix_;
    bool feeds_;
    double base_kva_;
};

} // namespace gridspace::sim
