// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

enum class GeneratorRole { slack, pv, pq };

/// Generator without dynamics of its own: holds voltage and angle, or power and voltage, or powers. In waveforms a
/// slack is an ideal source; the others are converters, whose reactive power integrates the voltage error (role pv).
struct Generator final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("power into the network; not of a slack")},
        {"q_kvar", elements::any("reactive power into the network; of role pq")},
        {"voltage_setpoint_pu", elements::positive("voltage that it holds; of roles slack and pv")}};
    static constexpr CommandUse kCommands[] = {
        {Command::connect, "puts it back into service; with phasors one of role pq, with waveforms no slack"},
        {Command::disconnect, "takes it out of service; with phasors one of role pq"}};
    static constexpr Kind kKind{.section = "generators",
                                .doc = "generators without dynamics",
                                .word = "generator",
                                .prefix = "generator",
                                .feeds = true,
                                .commands = kCommands,
                                .settable = kSettable};
    double rating_kva{0};
    GeneratorRole role{GeneratorRole::pv};
    double voltage_setpoint_pu{1}, angle_deg{0};
    double p_kw{0}, q_kvar{0};
    std::optional<double> q_min_kvar, q_max_kvar;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    [[nodiscard]] Complex sequence_pu(Sequence sequence, Surroundings const& around) const override;
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // a slack; the others' filters
    void power_flow(PowerFlowFace& face) const override;
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] std::optional<Refusal> refuses(std::string_view quantity, Surroundings const& around,
                                                 bool waveform) const override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override {
        return quantity == "p_kw" ? p_kw : quantity == "q_kvar" ? q_kvar : voltage_setpoint_pu;
    }
};

} // namespace gridspace::sim
