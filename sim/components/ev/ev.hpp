// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Battery of an electric vehicle behind an averaged DC-DC converter and a rectifier. States: battery current i (A),
/// state of charge (%). i' = (reference - i) / lag; soc' = 100 i V / capacity; power from the grid i V / efficiency, at
/// unity power factor. Charging stops exactly at soc_stop_percent.
struct Ev final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"current_a", elements::not_negative("battery current that its charger shall give; more than it can is less")}};
    static constexpr Kind kKind{.section = "evs",
                                .doc = "electric vehicles",
                                .word = "EV",
                                .prefix = "ev",
                                .commands = kConverter,
                                .settable = kSettable};
    double capacity_kwh{24}, battery_v{360}, max_current_a{15}, efficiency{0.95};
    double soc_start_percent{0}, soc_stop_percent{100};
    double current_lag_s{1}; ///< first-order response of the converter to its reference

    /// Power from the grid, W.
    [[nodiscard]] double power_w(double current_a) const { return current_a * battery_v / efficiency; }
    /// Charge that a current brings in a time, percent.
    [[nodiscard]] double charge_percent(double current_a, double h_s) const {
        return 100 * current_a * battery_v * h_s / (capacity_kwh * 1e3 * 3600);
    }
    [[nodiscard]] double reference_a(double wanted_a) const; ///< within what the battery takes
    [[nodiscard]] bool full_at_start() const { return soc_start_percent >= soc_stop_percent; }

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace&) const override {}                               // charges nothing at the start
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
};

} // namespace gridspace::sim
