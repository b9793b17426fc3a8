// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

#include <optional>

namespace gridspace::sim {

/// A circuit of the rotor, p.u. on the machine's rating, referred to the stator.
struct RotorCage {
    double r{0}, x{0};
};

/// Three-phase induction machine with one or two cages behind a contactor of its own. Its shaft carries a load whose
/// torque goes with a power of the speed; a negative one drives it. Star point not earthed.
struct InductionMachine final : OnePort, VoltageDependent {
    static constexpr Quantity kSettable[] = {
        {"load_kw", elements::any("mechanical power of its load at nominal speed; negative: it is driven")}};
    static constexpr Kind kKind{.section = "induction_machines",
                                .doc = "induction machines with their loads",
                                .word = "induction machine",
                                .prefix = "induction_machine",
                                .commands = kSwitched,
                                .settable = kSettable};
    double rating_kva{0};
    double load_kw{0};       ///< mechanical, at nominal speed
    double load_exponent{2}; ///< of the speed in the torque of the load
    double inertia_h_s{0};   ///< of machine and load together
    struct Constants {
        double rs{0}, xs{0}, xm{0};
        RotorCage cage;
        std::optional<RotorCage> second_cage;
    } pu;
    bool running{true}; ///< at the start; else its contactor is open and it stands still

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    [[nodiscard]] Complex sequence_pu(Sequence sequence, Surroundings const& around) const override;
    [[nodiscard]] bool closed_at_start() const override { return running; }
    void power_flow(PowerFlowFace& face) const override { face.draw(bus, *this, 1); }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] double value(std::string_view /*quantity*/, Surroundings const& /*around*/) const override {
        return load_kw;
    }

    // What it draws while it carries its load: multiples of its rating. Where it cannot carry it, the impedance that it
    // has at its breakdown torque.
    using VoltageDependent::factor;
    [[nodiscard]] VoltagePower factor(double v, double floor_pu) const override;
    [[nodiscard]] Complex nominal_kva() const override { return {rating_kva, rating_kva}; }
    [[nodiscard]] Complex nominal_kva(std::size_t /*phase*/) const override { return nominal_kva() / 3.0; }
    [[nodiscard]] std::pair<double, double> impedance_shares() const override { return {0, 0}; }
};

} // namespace gridspace::sim
