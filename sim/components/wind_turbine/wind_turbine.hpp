// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"
#include "sim/components/wind_turbine/wind_rotor.hpp"

namespace gridspace::sim {

/// full_converter (type 4 of IEC 61400-27-1): what the grid cannot take is burnt in a chopper, and the rotor does not
/// notice. doubly_fed (type 3): the rotor is left with what the grid does not take.
enum class WindGenerator { full_converter, doubly_fed };

/// Wind turbine with an averaged converter: power by its rotor (wind_rotor.hpp), reactive power as asked.
struct WindTurbine final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"wind_m_s", elements::not_negative("wind, instead of its profile")},
        {"p_limit_kw", elements::not_negative("gives no more, whatever the wind")},
        {"q_kvar", elements::any("reactive power into the network within its rating")}};
    static constexpr Kind kKind{.section = "wind_turbines",
                                .doc = "wind turbines with converters",
                                .word = "wind turbine",
                                .prefix = "wind_turbine",
                                .feeds = true,
                                .commands = kConverter,
                                .settable = kSettable};
    double rated_kw{0}, rating_kva{0}; ///< 0: 1.1 of rated_kw
    double wind_m_s{12}, q_kvar{0};
    Ref scale; ///< profile that multiplies the wind
    WindGenerator generator{WindGenerator::full_converter};
    wind::RotorData rotor;
    std::optional<RideThrough> ride_through;
    std::optional<double> wind_set_m_s, p_limit_kw; ///< set in a run

    [[nodiscard]] double converter_kva() const { return rating_kva > 0 ? rating_kva : 1.1 * rated_kw; }
    /// Wind at a value of its profile.
    [[nodiscard]] double wind(double times) const { return wind_set_m_s.value_or(wind_m_s * times); }
    /// Power into the network while the converter takes `taken_pu` from its generator, kVA.
    [[nodiscard]] Complex power_kva(double taken_pu) const;
    [[nodiscard]] wind::Operation operation(double wind, bool runs) const;
    /// Runs and is steady, or stands because of its wind.
    [[nodiscard]] wind::State start(double wind) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return ride_through ? "the ride-through of" : "";
    }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override;
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override;
};

} // namespace gridspace::sim
