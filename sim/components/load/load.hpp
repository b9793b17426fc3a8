// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

#include <array>
#include <optional>
#include <vector>

namespace gridspace::sim {

/// `dc_*`: behind a rectifier. `dc_resistive` draws with the square of the voltage; `dc_constant_power` is held by a
/// converter.
enum class LoadModel {
    constant_power,
    constant_current,
    constant_impedance,
    exponential,
    zip,
    dc_resistive,
    dc_constant_power
};

/// Load: P = p · scale(t) · f(v), Q alike, f by its model, with a first-order lag of lag_s. In waveforms an impedance
/// draws the nominal powers, and an injection that follows the voltage what they are not.
struct Load final : OnePort, VoltageDependent {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("active power at 1 p.u.; not of a load with powers by phase")},
        {"q_kvar", elements::any("reactive power at 1 p.u., instead of a power factor; not of a DC load")},
        {"power_factor", elements::at_most_one("lagging; not of a DC load")},
        {"demand_pu", elements::not_negative("times what it draws otherwise, its profile included")}};
    static constexpr Kind kKind{.section = "loads",
                                .doc = "loads",
                                .word = "load",
                                .prefix = "load",
                                .commands = kInService,
                                .settable = kSettable};
    double p_kw{0};
    double power_factor{1};       ///< lagging, > 0
    std::optional<double> q_kvar; ///< instead of a power factor
    LoadModel model{LoadModel::constant_power};
    double exponent_p{0}, exponent_q{0};
    std::array<double, 3> zip_p{0, 0, 1}, zip_q{0, 0, 1}; ///< shares of constant impedance, current, power
    std::vector<double> phase_p_kw, phase_q_kvar;         ///< a, b, c between phase and earth; empty: a third each
    double lag_s{0};
    Ref scale;           ///< profile that multiplies p and q
    double demand_pu{1}; ///< multiplies them too; set in a run

    /// Reactive power at nominal voltage, from its power factor or as given.
    [[nodiscard]] double nominal_q_kvar() const;
    [[nodiscard]] bool is_dc() const {
        return model == LoadModel::dc_resistive || model == LoadModel::dc_constant_power;
    }

    using VoltageDependent::factor;
    [[nodiscard]] VoltagePower factor(double v, double floor_pu) const override;
    [[nodiscard]] Complex nominal_kva() const override { return {p_kw * demand_pu, nominal_q_kvar() * demand_pu}; }
    [[nodiscard]] Complex nominal_kva(std::size_t phase) const override;
    [[nodiscard]] std::pair<double, double> impedance_shares() const override;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return unbalanced() ? "powers by phase: they take a third of the sum for each of load" : "";
    }
    [[nodiscard]] bool unbalanced() const override { return !phase_p_kw.empty(); }
    [[nodiscard]] Complex admittance_kva(double) const override { return std::conj(nominal_kva()); }
    void power_flow(PowerFlowFace& face) const override { face.draw(bus, *this, face.scale(scale)); }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] std::optional<Refusal> refuses(std::string_view quantity, Surroundings const& around,
                                                 bool waveform) const override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const& around) const override;
};

} // namespace gridspace::sim
