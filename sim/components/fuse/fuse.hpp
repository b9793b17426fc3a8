// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/line_device.hpp"

#include <optional>
#include <vector>

namespace gridspace::sim {

/// Data of a fuse as its maker publishes them: minimum melting (pre-arcing) time over current, r.m.s. [IEEE C37.41 and
/// C37.46, IEC 60282-1], and the pre-arcing integral of short times [IEC 60269-1].
struct FuseType final : Element {
    static constexpr Kind kKind{.section = "fuse_types", .doc = "fuse data", .word = "fuse type"};
    double rated_a{0};
    std::vector<double> melting_a, melting_s; ///< points of the curve, by rising current
    std::optional<double> i2t_a2s;            ///< without it: that of the last point
    double arcing_ms{0};
    enum class Opens { each_pole_at_current_zero, at_once } opens{Opens::each_pole_at_current_zero};

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    /// How long a link carries this current until it melts, s: a straight line between the logarithms of two points;
    /// beyond the last one I2t stays what it is there. Infinite below the first.
    [[nodiscard]] double melting_time_s(double i_a) const;
    [[nodiscard]] double adiabatic_a2s() const {
        return i2t_a2s.value_or(melting_a.back() * melting_a.back() * melting_s.back());
    }
};

/// Three links at one end of a line; each melts by its own current (sim/runtime/fuse_engine.hpp).
struct Fuse final : LineSwitch {
    static constexpr CommandUse kCommands[] = {{Command::open, "its links are taken out, as the type opens"},
                                               {Command::close, "new links are put in"}};
    static constexpr Kind kKind{
        .section = "fuses", .doc = "fuses at line ends", .word = "fuse", .prefix = "fuse", .commands = kCommands};
    Ref type;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.exists(FuseType::kKind, type); }
    [[nodiscard]] std::string_view unseen_by_phasors() const override { return "the single poles of fuse"; }
    [[nodiscard]] emt::Opening opening(Surroundings const& around) const override;
};

} // namespace gridspace::sim
