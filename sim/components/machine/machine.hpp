// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"
#include "sim/components/machine/regulators.hpp"

#include <optional>

namespace gridspace::sim {

/// S(1.0) and S(1.2) of the open-circuit curve: what the field needs more than on the air-gap line, per unit of that.
struct OpenCircuitSaturation {
    double s10{0}, s12{0};
};

/// `full`: one field winding and one damper per axis. `classical`: constant voltage behind xd1.
enum class MachineModel { full, classical };

/// Synchronous machine constants, p.u. on the machine's own rating.
struct MachineType final : Element {
    static constexpr Kind kKind{.section = "machine_types", .doc = "synchronous machine data", .word = "machine type"};
    MachineModel model{MachineModel::full};
    struct Constants {
        double xd{0}, xq{0}, xd1{0}, xd2{0}, xq2{0}, xl{0}, x0{0}, ra{0};
    } pu;
    double td01_s{0}, td02_s{0}, tq02_s{0};
    double inertia_h_s{0};
    double damping_pu{0};
    std::optional<OpenCircuitSaturation> saturation;
    std::optional<Avr> avr;
    std::optional<Governor> governor;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
};

/// Synchronous machine with regulators: the rotor of rotor_equations.hpp in every solver; stators differ.
struct Machine final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("power at nominal speed that its governor holds")},
        {"voltage_setpoint_pu", elements::positive("voltage that its regulator holds")},
        {"droop_percent", elements::positive("of its governor")},
        {"frequency_setpoint_hz",
         elements::positive("frequency that its governor holds, from half to 1.5 times the nominal one")}};
    static constexpr CommandUse kCommands[] = {kOnlyOut[0], {Command::mode, "how its governor works"}};
    static constexpr Mode kModes[] = {
        {"isochronous", "droop and integral: the frequency comes back; needs an `integral_ki`, or is a `degov`"},
        {"droop", "its integral stays where it is"},
        {"fixed_power", "it gives its `p_kw` at any frequency, and its integral stays where it is"}};
    static constexpr Kind kKind{.section = "machines",
                                .doc = "synchronous machines",
                                .word = "machine",
                                .prefix = "machine",
                                .feeds = true,
                                .has_signals = false,
                                .commands = kCommands,
                                .settable = kSettable,
                                .modes = kModes};
    Ref type;
    double rating_kva{0};
    double p_kw{0};
    double voltage_setpoint_pu{1};
    std::optional<double> inertia_h_s; ///< overrides the type's
    std::optional<Governor> governor;  ///< overrides the type's

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.exists(MachineType::kKind, type); }
    [[nodiscard]] Complex sequence_pu(Sequence sequence, Surroundings const& around) const override;
    [[nodiscard]] bool earthed(Surroundings const& around) const override;
    void power_flow(PowerFlowFace& face) const override {
        face.regulate(bus,
                      {.p_kw = p_kw, .voltage_pu = voltage_setpoint_pu, .rating_kva = rating_kva, .keeps_alive = true});
    }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] std::optional<Refusal> refuses(std::string_view quantity, Surroundings const& around,
                                                 bool waveform) const override;
    [[nodiscard]] std::optional<Refusal> refuses_mode(std::string_view mode, Surroundings const& around) const override;
    [[nodiscard]] config::NumberSpec range(Quantity const& quantity, Surroundings const& around, bool) const override {
        return quantity.name == "frequency_setpoint_hz" ? elements::near_nominal(quantity.range, around.frequency_hz())
                                                        : quantity.range;
    }
    [[nodiscard]] double value(std::string_view quantity, Surroundings const& around) const override;

  private:
    [[nodiscard]] Governor const* governor_of(Surroundings const& around) const;
};

} // namespace gridspace::sim
