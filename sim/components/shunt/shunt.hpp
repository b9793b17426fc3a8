// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Fixed admittance to earth.
struct Shunt final : OnePort {
    static constexpr Kind kKind{.section = "shunts",
                                .doc = "shunts",
                                .word = "shunt",
                                .prefix = "shunt",
                                .has_signals = false,
                                .commands = kInService};
    double p_kw{0};   ///< consumed at 1 p.u.
    double q_kvar{0}; ///< produced at 1 p.u. (a capacitor is positive)

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    [[nodiscard]] Complex admittance_kva(double) const override { return {p_kw, q_kvar}; }
    void power_flow(PowerFlowFace& face) const override { face.admit(bus, {p_kw, q_kvar}); }
    void circuit(CircuitFace& face) const override { face.star(*this); }
};

} // namespace gridspace::sim
