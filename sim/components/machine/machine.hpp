// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

#include <limits>

namespace gridspace::sim {

/// Limits of the field voltage that go with the terminal voltage: VRMAX, VRMIN and KC of ST1A.
struct FieldCeiling {
    double max_pu{0}, min_pu{0};
    double kc_pu{0}; ///< what the upper one loses per p.u. of field current: the rectifier's commutation
};

/// Power system stabilizer PSS1A with the speed as its input (IEEE 421.5).
struct Stabilizer {
    double gain{0}, washout_s{10};
    double t1_s{0}, t2_s{0}, t3_s{0}, t4_s{0}; ///< (1 + t1 s) / (1 + t2 s), and the same with t3 and t4
    double min_pu{-0.1}, max_pu{0.1};
};

/// Voltage regulator and static exciter: ST1A of IEEE 421.5, of which the first line is the simplest form.
struct Avr {
    double ka{0}, ta_s{0}, tr_s{0}, efd_min_pu{0}, efd_max_pu{0};
    double tc_s{0}, tb_s{0}; ///< (1 + tc s) / (1 + tb s) before the gain
    double kf{0}, tf_s{1};   ///< kf s / (1 + tf s), back from the field voltage
    std::optional<FieldCeiling> ceiling;
    std::optional<Stabilizer> stabilizer;
};

/// AT, KT and T3 of GAST.
struct TurbineLoadLimit {
    double power_pu{1}, gain{2}, t_s{3};
};

/// Speed governor and turbine: TGOV1 with an integral, and with a load limit the gas turbine GAST. p.u. of the
/// machine's rating.
struct Governor {
    double droop_percent{4};
    double tg_s{0}, tt_s{0};
    double integral_ki{0};
    std::optional<double> gate_min_pu, gate_max_pu; ///< of the servo; without: any
    double lead_s{0};                               ///< of the turbine: what of its power comes at once
    double damping_pu{0};                           ///< power that the turbine loses per p.u. of speed
    std::optional<TurbineLoadLimit> load_limit;     ///< by the temperature of the exhaust

    [[nodiscard]] double lowest() const { return gate_min_pu.value_or(-std::numeric_limits<double>::infinity()); }
    [[nodiscard]] double highest() const { return gate_max_pu.value_or(std::numeric_limits<double>::infinity()); }
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
        {"isochronous", "droop and integral: the frequency comes back; needs an `integral_ki`"},
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
