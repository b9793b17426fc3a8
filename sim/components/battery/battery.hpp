// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Stationary battery behind an averaged converter. State: state of charge (%), which stops exactly at its limits.
struct Battery final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("power into the network, within its rating; negative: charging")},
        {"q_kvar", elements::any("reactive power into the network")}};
    static constexpr Kind kKind{.section = "batteries",
                                .doc = "stationary batteries",
                                .word = "battery",
                                .prefix = "battery",
                                .feeds = true,
                                .commands = kConverter,
                                .settable = kSettable};
    double capacity_kwh{0}, rating_kva{0};
    double p_kw{0}, q_kvar{0}; ///< into the network: discharging is positive
    double efficiency{0.95};   ///< of the converter, each way
    double soc_start_percent{50}, soc_min_percent{0}, soc_max_percent{100};
    Ref scale; ///< profile that multiplies p

    /// What it is asked to give its bus (negative: take) within its rating, kW, at a value of its profile.
    [[nodiscard]] double asked_kw(double times) const;
    /// The same at a state of charge: nothing out of an empty one or into a full one.
    [[nodiscard]] double asked_kw(double times, double soc_percent) const;
    /// Change of its state of charge while it gives `given_kw`, percent per second.
    [[nodiscard]] double soc_slope(double given_kw) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.profile(scale); }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override {
        face.inject(bus, {asked_kw(face.scale(scale), soc_start_percent), q_kvar});
    }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override {
        (quantity == "p_kw" ? p_kw : q_kvar) = value;
        return true;
    }
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override {
        return quantity == "p_kw" ? p_kw : q_kvar;
    }
};

} // namespace gridspace::sim
