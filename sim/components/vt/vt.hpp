// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/instrument_keys.hpp"
#include "sim/components/faces/line_device.hpp"

namespace gridspace::sim {

/// Two-slope core of a voltage transformer, seen from its primary.
struct VtSaturation {
    double knee_pu{1.9};      ///< flux linkage at the knee, of that of nominal voltage
    double magnetising_ma{0}; ///< r.m.s. primary current there
    double winding_ohm{0};    ///< of the primary
    double air_core_mh{0};    ///< inductance beyond the knee
};

struct VtType final : Element {
    static constexpr Kind kKind{.section = "vt_types", .doc = "voltage transformer data", .word = "VT type"};
    std::string ratio{"1:1"};
    double primary_v{1}, secondary_v{1};
    double error_percent{0};
    InstrumentFilter filter;
    double quantum_mv{0}; ///< primary values are rounded to whole quanta; 0: not
    std::optional<VtSaturation> saturation;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
};

/// Voltage transformers of the three phases, phase to earth, at a bus: flux' = v - winding i_m(flux), which they show.
struct Vt final : Instrument {
    static constexpr Kind kKind{.section = "vts", .doc = "voltage transformers at buses", .word = "VT", .prefix = "vt"};
    Ref bus;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.exists(VtType::kKind, type); }
    [[nodiscard]] Place place() const override { return {.bus = bus}; }
    [[nodiscard]] emt::InstrumentData data(Surroundings const& around) const override;
    [[nodiscard]] Ratio ratio(Surroundings const& around) const override {
        VtType const* found = around.find<VtType>(type);
        return found == nullptr ? Ratio{} : Ratio{found->primary_v, found->secondary_v};
    }
};

} // namespace gridspace::sim
