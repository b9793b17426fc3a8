// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {

/// Photovoltaic inverter: active power by a profile, limited by the rating, at a fixed power factor.
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
    double p_kw{0}, rating_kva{0}; ///< at full sun; 0: no limit
    double power_factor{1};        ///< takes reactive power
    Ref scale;                     ///< profile of the sun
    std::optional<RideThrough> ride_through;
    std::optional<double> p_limit_kw, q_kvar, irradiance_pu; ///< set in a run

    /// Power into the network at a value of the profile, kVA.
    [[nodiscard]] Complex power_kva(double sun) const;
    /// Rating of the inverter, kVA; that of full sun when none is given.
    [[nodiscard]] double inverter_kva() const { return rating_kva > 0 ? rating_kva : p_kw / power_factor; }

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.profile(scale); }
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return ride_through ? "the ride-through of" : "";
    }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override { face.inject(bus, power_kva(face.scale(scale))); }
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view quantity, double value) override;
    [[nodiscard]] double value(std::string_view quantity, Surroundings const&) const override;
};

} // namespace gridspace::sim
