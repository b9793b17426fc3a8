// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/instrument_keys.hpp"
#include "sim/components/faces/line_device.hpp"

namespace gridspace::sim {

/// Two-slope core of a current transformer and what it drives, seen from its secondary.
struct CtSaturation {
    double knee_v{0};         ///< r.m.s. secondary voltage at base frequency at which the core leaves its first slope
    double magnetising_ma{0}; ///< r.m.s. secondary current there
    double winding_ohm{0}, burden_ohm{0};
    double air_core_mh{0};       ///< inductance beyond the knee
    double remanence_percent{0}; ///< of the flux at the knee, at the start, in every phase
};

struct CtType final : Element {
    static constexpr Kind kKind{.section = "ct_types", .doc = "current transformer data", .word = "CT type"};
    std::string ratio{"1:1"};
    double primary_a{1}, secondary_a{1}; ///< of the ratio
    double error_percent{0};
    InstrumentFilter filter;
    double quantum_ma{0}; ///< values are rounded to whole quanta; 0: not
    std::optional<CtSaturation> saturation;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
};

enum class CtPolarity { from_to, into_line };

/// Current transformers of the three phases, on the line side of the breaker: flux' = (winding + burden) i_s,
/// i_s = i_p / n - i_m(flux).
struct Ct final : Instrument {
    static constexpr Kind kKind{
        .section = "cts", .doc = "current transformers at line ends", .word = "CT", .prefix = "ct"};
    Ref line;
    LineEnd end{LineEnd::from};
    CtPolarity positive{CtPolarity::from_to};

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.exists(CtType::kKind, type); }
    [[nodiscard]] Place place() const override { return {.line = line, .end = end}; }
    [[nodiscard]] emt::InstrumentData data(Surroundings const& around) const override;
    [[nodiscard]] Ratio ratio(Surroundings const& around) const override {
        CtType const* found = around.find<CtType>(type);
        return found == nullptr ? Ratio{} : Ratio{found->primary_a, found->secondary_a};
    }
};

} // namespace gridspace::sim
