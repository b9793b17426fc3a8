// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Ideal three-phase voltage behind an impedance: v_a = sqrt(2/3) V cos(w t + angle), with harmonics in waveforms.
/// Without an impedance it holds its bus.
struct Source final : OnePort {
    static constexpr Quantity kSettable[] = {
        {.name = "voltage_pu", .range = elements::not_negative("its internal voltage")},
        {.name = "frequency_hz",
         .range =
             elements::positive("its frequency, the phase goes on; with phasors behind an impedance, and from half to "
                                "1.5 times the nominal one"),
         .turns_voltages = true}};
    static constexpr CommandUse kCommands[] = {{Command::disconnect, "takes it out of service", false}};
    static constexpr Kind kKind{.section = "sources",
                                .doc = "stiff networks behind an impedance",
                                .word = "source",
                                .prefix = "source",
                                .feeds = true,
                                .commands = kCommands,
                                .settable = kSettable};
    double voltage_pu{1}, angle_deg{0};
    double r_ohm{0}, l_mh{0};
    std::optional<double> r0_ohm, l0_mh; ///< zero sequence; positive sequence values when not given
    struct Harmonic {
        std::int64_t order{1};
        double percent{0}, angle_deg{0};
    };
    std::vector<Harmonic> harmonics;

    [[nodiscard]] bool ideal() const { return r_ohm == 0 && l_mh == 0; }
    [[nodiscard]] Complex z1_ohm(double omega) const { return {r_ohm, omega * l_mh * 1e-3}; }
    [[nodiscard]] Complex z0_ohm(double omega) const {
        return {r0_ohm.value_or(r_ohm), omega * l0_mh.value_or(l_mh) * 1e-3};
    }

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return harmonics.empty() ? "" : "the harmonics of source";
    }
    [[nodiscard]] Complex sequence_pu(Sequence sequence, Surroundings const& around) const override;
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; }
    void power_flow(PowerFlowFace& face) const override {
        face.source(bus, {voltage_pu, angle_deg, z1_ohm(face.omega()), z0_ohm(face.omega())});
    }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override {
        voltage_pu = quantity == "voltage_pu" ? value : voltage_pu;
        return true;
    }
    [[nodiscard]] std::optional<Refusal> refuses(std::string_view quantity, Surroundings const& around,
                                                 bool waveform) const override;
    /// Phasors turn against a reference of nominal frequency, in which a network has its reactances.
    [[nodiscard]] config::NumberSpec range(Quantity const& quantity, Surroundings const& around,
                                           bool waveform) const override {
        return quantity.turns_voltages && !waveform ? elements::near_nominal(quantity.range, around.frequency_hz())
                                                    : quantity.range;
    }
    [[nodiscard]] double value(std::string_view quantity, Surroundings const& around) const override {
        return quantity == "voltage_pu" ? voltage_pu : around.frequency_hz();
    }
};

} // namespace gridspace::sim
