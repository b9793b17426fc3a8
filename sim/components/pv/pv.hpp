// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"
#include "sim/components/pv/pv_array.hpp"

namespace gridspace::sim {

/// Photovoltaic inverter: active power by a profile of the sun, or of its cells at that sun and at their maximum power
/// point (pv_array.hpp), limited by the rating, at a fixed power factor.
struct Pv final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_limit_kw", elements::not_negative("gives no more, whatever the sun")},
        {"q_kvar", elements::any("reactive power into the network within its rating, instead of a power factor")},
        {"power_factor", elements::at_most_one("takes reactive power")},
        {"irradiance_pu", elements::not_negative("sun, instead of its profile")}};
    static constexpr Kind kKind{.section = "pv",
                                .doc = "photovoltaic inverters",
                                .word = "PV",
                                .prefix = "pv",
                                .feeds = true,
                                .commands = kConverter,
                                .settable = kSettable};
    double p_kw{0}, rating_kva{0}; ///< at full sun (of an array: at 25 degrees); 0: no limit
    double power_factor{1};        ///< takes reactive power
    Ref scale;                     ///< profile of the sun
    std::optional<PvArray> array;
    double ambient_c{25};
    Ref ambient; ///< profile that multiplies ambient_c
    std::optional<RideThrough> ride_through;
    std::optional<double> p_limit_kw, q_kvar, irradiance_pu; ///< set in a run

    /// Power into the network of `most_kw` that its cells can give, kVA.
    [[nodiscard]] Complex power_kva(double most_kw) const;
    /// What its cells can give at values of its profiles.
    struct Weather {
        double sun{1}, ambient{1};
    };
    [[nodiscard]] double available_kw(Weather const& weather) const;
    [[nodiscard]] PvArray::Module module_at(Weather const& weather) const;
    /// And what they give while a tracker has them at this voltage of their diodes.
    [[nodiscard]] double tracked_kw(Weather const& weather, double diode_v) const;
    /// Rating of the inverter, kVA; that of full sun when none is given.
    [[nodiscard]] double inverter_kva() const { return rating_kva > 0 ? rating_kva : p_kw / power_factor; }

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override {
        check.profile(scale);
        check.profile(ambient);
    }
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return ride_through ? "the ride-through of" : "";
    }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override {
        face.inject(bus, power_kva(available_kw({face.scale(scale), face.scale(ambient)})));
    }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override;
};

} // namespace gridspace::sim
