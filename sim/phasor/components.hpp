// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"
#include "sim/phasor/component.hpp"

#include <functional>

namespace gridspace::sim::phasor {

/// Value of an element's profile at t seconds; 1 without one.
using Scale = std::function<double(double t)>;

/// Load: P and Q follow voltage by the load's model and time by its profile, with a first-order lag of lag_s.
/// States (with a lag): p, q.
class LoadComponent final : public Component {
  public:
    LoadComponent(Load const& load, std::size_t bus, double base_kva, Scale scale);
    [[nodiscard]] std::size_t states() const override { return load_.lag_s > 0 ? 2 : 0; }
    void start(double t, Complex v, std::span<double> x) override;
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    void set_power(double p_kw) { load_.p_kw = p_kw; }
    void set_connected(bool connected) { connected_ = connected; }

  private:
    [[nodiscard]] Complex demand(double t, double v) const;
    [[nodiscard]] Complex power(double t, std::span<double const> x, double v) const;
    Load load_;
    double base_kva_;
    Scale scale_;
    bool connected_{true};
};

/// Photovoltaic inverter: P by its profile, limited by its rating, at a fixed power factor.
class PvComponent final : public Component {
  public:
    PvComponent(Pv const& pv, std::size_t bus, double base_kva, Scale scale);
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    void set_connected(bool connected) { connected_ = connected; }

  private:
    [[nodiscard]] Complex power(double t, double v) const;
    Pv pv_;
    double base_kva_;
    Scale scale_;
    bool connected_{true};
};

/// EV battery behind an averaged converter. States: battery current i (A), state of charge (%).
/// i' = (i_ref - i) / lag; soc' = 100 i V_battery / capacity; grid power i V_battery / efficiency, unity power factor.
/// Charging stops exactly at soc_stop_percent (an event).
class EvComponent final : public Component {
  public:
    EvComponent(Ev const& ev, std::size_t bus, double base_kva);
    [[nodiscard]] std::size_t states() const override { return 2; }
    void start(double t, Complex v, std::span<double> x) override;
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] bool has_event() const override { return !full_; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override;
    void on_event(std::span<double> x) override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    void set_reference(double current_a);
    void set_connected(bool connected) { connected_ = connected; }

  private:
    [[nodiscard]] double power_kw(double current_a) const;
    Ev ev_;
    double base_kva_;
    double reference_a_{0};
    bool full_{false};
    bool connected_{true};
};

/// Stationary battery behind an averaged converter. State: state of charge (%), which stops exactly at its limits.
class BatteryComponent final : public Component {
  public:
    BatteryComponent(Battery const& battery, std::size_t bus, double base_kva, Scale scale);
    [[nodiscard]] std::size_t states() const override { return 1; }
    void start(double t, Complex v, std::span<double> x) override;
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] bool has_event() const override { return true; }
    [[nodiscard]] double event(double t, std::span<double const> x) const override;
    void on_event(std::span<double> x) override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    void set_power(double p_kw, double q_kvar) {
        battery_.p_kw = p_kw;
        battery_.q_kvar = q_kvar;
    }
    [[nodiscard]] Battery const& data() const { return battery_; }
    void set_connected(bool connected) { connected_ = connected; }

  private:
    [[nodiscard]] double asked_kw(double t) const;
    [[nodiscard]] Complex power(double t, double v) const;
    Battery battery_;
    int at_{0}; ///< -1: empty, 1: full; then it gives, or takes, nothing
    double base_kva_;
    Scale scale_;
    bool connected_{true};
};

/// Ideal source behind an impedance.
class SourceComponent final : public Component {
  public:
    SourceComponent(Network const& network, Source const& source, std::size_t bus);
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;

  private:
    std::string name_;
    double base_kva_;
    Complex emf_, admittance_;
};

/// Generator with given powers (role pq; pv in quasi-static runs is a held voltage, see PhasorEngine).
class FixedPowerComponent final : public Component {
  public:
    FixedPowerComponent(std::string name, Complex power_pu, double rating_pu, std::size_t bus, double base_kva);
    Complex flow(double t, std::span<double const> x, Complex v, std::span<double> dx) const override;
    [[nodiscard]] std::vector<SignalDef> signals() const override;
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const> x, Complex v) const override;
    void set_connected(bool connected) { connected_ = connected; }

  private:
    [[nodiscard]] Complex power(Complex v) const;
    std::string name_;
    Complex power_;
    double rating_, base_kva_;
    bool connected_{true};
};

} // namespace gridspace::sim::phasor
