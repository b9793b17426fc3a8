// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// A bank of electric double-layer capacitors behind an averaged converter: C, a series resistance R and a leakage
/// parallel to C, the classical equivalent circuit. [Spyker and Nelms, Classical equivalent circuit parameters for a
/// double-layer capacitor, IEEE Trans. Aerosp. Electron. Syst. 36(3), 2000]
///
///     C V' = -I - V / R_leak,   P = (V - I R) I   out of the bank, P = p / efficiency or p efficiency
///
/// State: the energy C V^2 / 2, in percent of that at rated voltage (its state of charge), which has a finite slope
/// where V has none. It stops exactly at the limits of V.
struct Supercapacitor final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::any("power into the network, within its rating; negative: charging")},
        {"q_kvar", elements::any("reactive power into the network")}};
    static constexpr Kind kKind{.section = "supercapacitors",
                                .doc = "banks of supercapacitors",
                                .word = "supercapacitor",
                                .prefix = "supercapacitor",
                                .feeds = true,
                                .commands = kConverter,
                                .settable = kSettable};
    double capacitance_f{0}, esr_ohm{0}; ///< of the bank
    double leakage_ohm{0};               ///< 0: none
    double rated_voltage_v{0}, v_min_v{0}, v_start_v{0};
    double i_max_a{0}; ///< 0: no limit
    double rating_kva{0};
    double p_kw{0}, q_kvar{0}; ///< into the network: discharging is positive
    double efficiency{0.95};   ///< of the converter, each way
    Ref scale;                 ///< profile that multiplies p
    std::optional<RideThrough> ride_through;

    /// Whether it is at a limit of its voltage.
    struct Limits {
        bool empty{false}, full{false};
    };
    [[nodiscard]] double soc_percent(double v) const { return 100 * (v / rated_voltage_v) * (v / rated_voltage_v); }
    /// Of the capacitance, at a state of charge.
    [[nodiscard]] double voltage_v(double soc) const;
    /// What it is asked to give its bus (negative: take) within its rating, kW, at a value of its profile.
    [[nodiscard]] double asked_kw(double times) const;
    /// Current out of the bank while its converter is asked for `p_kw`: within i_max_a, and no more than gives the
    /// largest power, V / 2R. At its limits nothing comes out of it, or only its leakage goes into it.
    [[nodiscard]] double current_a(double p_kw, double v, Limits at) const;
    /// Power into the network that this current carries, kW.
    [[nodiscard]] double given_kw(double current_a, double v) const;
    /// What its converter would give, what the voltage v of its bus (p.u.) lets through, and the current of that.
    struct Working {
        Complex wanted_kva, given_kva;
        double current_a{0};
    };
    [[nodiscard]] Working working(double times, double soc, Limits at, double v) const;
    /// Percent per second.
    [[nodiscard]] double soc_slope(double current_a, double v) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.profile(scale); }
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return ride_through ? "the ride-through of" : "";
    }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override;
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override {
        return quantity == "p_kw" ? p_kw : q_kvar;
    }
};

} // namespace gridspace::sim
