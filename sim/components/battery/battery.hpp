// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/battery/grid_forming.hpp"
#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// grid_following: gives its powers to whatever voltage there is; grid_forming: is a voltage (grid_forming.hpp).
enum class BatteryControl { grid_following, grid_forming };

/// Stationary battery behind an averaged converter. State: state of charge (%), which stops exactly at its limits.
struct Battery final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("power into the network, within its rating; negative: charging")},
        {"q_kvar", elements::any("reactive power into the network")},
        {"voltage_setpoint_pu", elements::positive("grid-forming: voltage that it holds")},
        {"droop_percent", elements::positive("grid-forming: frequency drop at rated active power")},
        {"frequency_setpoint_hz",
         elements::positive("grid-forming: frequency at its p_kw, from half to 1.5 times the nominal one")}};
    static constexpr CommandUse kCommands[] = {kConverter[0],
                                               kConverter[1],
                                               kConverter[2],
                                               kConverter[3],
                                               {Command::mode, "how a grid-forming one holds the frequency"}};
    static constexpr Mode kModes[] = {
        {"isochronous", "droop and integral: the frequency comes back; needs an `integral_ki`"},
        {"droop", "its integral stays where it is"}};
    static constexpr Kind kKind{.section = "batteries",
                                .doc = "stationary batteries",
                                .word = "battery",
                                .prefix = "battery",
                                .feeds = true,
                                .commands = kCommands,
                                .settable = kSettable,
                                .modes = kModes};
    double capacity_kwh{0}, rating_kva{0};
    double p_kw{0}, q_kvar{0}; ///< into the network: discharging is positive
    double efficiency{0.95};   ///< of the converter, each way
    double soc_start_percent{50}, soc_min_percent{0}, soc_max_percent{100};
    Ref scale; ///< profile that multiplies p
    BatteryControl control{BatteryControl::grid_following};
    GridForming forming;
    std::optional<RideThrough> ride_through;
    double frequency_setpoint_hz{0}; ///< set in a run

    [[nodiscard]] bool forms() const { return control == BatteryControl::grid_forming; }
    /// What it is asked to give its bus (negative: take) within its rating, kW, at a value of its profile.
    [[nodiscard]] double asked_kw(double times) const;
    /// The same at a state of charge: nothing out of an empty one or into a full one.
    [[nodiscard]] double asked_kw(double times, double soc_percent) const;
    /// Change of its state of charge while it gives `given_kw`, percent per second.
    [[nodiscard]] double soc_slope(double given_kw) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.profile(scale); }
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return ride_through ? "the ride-through of" : "";
    }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    [[nodiscard]] Complex sequence_pu(Sequence sequence, Surroundings const& around) const override;
    void power_flow(PowerFlowFace& face) const override;
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
};

} // namespace gridspace::sim
