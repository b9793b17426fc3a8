// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/machine/machine.hpp"
#include "sim/components/machine/saturation.hpp"

#include <cstddef>
#include <optional>

namespace gridspace::sim::machines {

/// A synchronous machine as equations see it: p.u. on its own rating, times in seconds. Derived factors are computed
/// once.
struct MachineData {
    double xd{0}, xq{0}, xd1{0}, x2d{0}, x2q{0}, xl{0}, x0{0}, ra{0};
    double td01{0}, td02{0}, tq02{0};
    double h{0}, damping{0};
    bool classical{false}; ///< constant voltage behind xd1; no rotor circuits
    std::optional<Avr> avr;
    std::optional<Governor> governor;
    double rating_kva{0};

    std::size_t states{0}; ///< how many of StateIndex move
    double gamma_d{0};     ///< (x2d - xl) / (xd1 - xl): share of E'q in the subtransient flux
    double gamma_q{0};     ///< (xq - x2q) / (xq - xl): share of the q damper
    double coupling{0};    ///< (xd1 - x2d) / (xd1 - xl)^2
    Saturation saturation; ///< of E'q, as in GENSAL of PSS/E
    Saturation exciter;    ///< of the alternator of AC8B

    /// The reactance behind which both engines see the subtransient flux: the mean of both axes.
    [[nodiscard]] double x2() const { return (x2d + x2q) / 2; }
    [[nodiscard]] bool round_subtransient() const { return x2d == x2q; }
};

[[nodiscard]] MachineData machine_data(Machine const& machine, Surroundings const& around);

} // namespace gridspace::sim::machines
