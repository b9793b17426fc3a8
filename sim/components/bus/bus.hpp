// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

namespace gridspace::sim {

/// A voltage phasor.
struct Polar {
    double v_pu{1}, angle_deg{0};
};

struct Bus final : Element {
    static constexpr Kind kKind{.section = "buses", .doc = "buses", .word = "bus", .prefix = "bus"};
    double voltage_v{0}; ///< nominal, line to line, r.m.s.
    std::optional<double> diagram_x, diagram_y;
    /// Where a power flow begins, when the network came with a solution (MATPOWER's VM and VA).
    std::optional<Polar> start;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
};

} // namespace gridspace::sim
