// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Three-phase capacitor bank, an earthed star behind a switch: Q = q (v / rated)^2, C = q / (w rated^2) each phase.
/// Opened, its phases keep the voltage at which their current passed through zero (waveforms).
struct ShuntCapacitor final : OnePort {
    static constexpr Kind kKind{.section = "shunt_capacitors",
                                .doc = "switched capacitor banks",
                                .word = "shunt capacitor",
                                .prefix = "shunt_capacitor",
                                .feeds = true,
                                .commands = kSwitched};
    double q_kvar{0};   ///< given at its rated voltage and nominal frequency
    double rated_kv{0}; ///< line to line, r.m.s.
    bool closed{true};  ///< at the start

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    [[nodiscard]] Complex admittance_kva(double voltage_v) const override;
    [[nodiscard]] bool closed_at_start() const override { return closed; }
    void power_flow(PowerFlowFace& face) const override { face.admit(bus, admittance_kva(face.voltage_v(bus))); }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override { face.star(*this); }
};

} // namespace gridspace::sim
