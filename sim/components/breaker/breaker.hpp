// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/line_device.hpp"

namespace gridspace::sim {

struct BreakerType final : Element {
    static constexpr Kind kKind{.section = "breaker_types", .doc = "breaker data", .word = "breaker type"};
    double mechanism_ms{0};
    enum class Opens { each_pole_at_current_zero, at_once } opens{Opens::each_pole_at_current_zero};
    double chop_a{0};   ///< a pole that opens interrupts a current below
    bool latched{true}; ///< a false trip signal never closes it

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
};

/// Three-pole breaker at one end of a line.
struct Breaker final : LineSwitch {
    static constexpr CommandUse kCommands[] = {
        {Command::open, "opens its poles after its mechanism's time; a stuck one stays closed"},
        {Command::close, "closes its poles"},
        {Command::reset, "its mechanism works again, if it was stuck (`fail_to_open`)"}};
    static constexpr Kind kKind{.section = "breakers",
                                .doc = "breakers at line ends",
                                .word = "breaker",
                                .prefix = "breaker",
                                .commands = kCommands};
    Ref type;
    bool closed{true};

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.exists(BreakerType::kKind, type); }
    [[nodiscard]] bool closed_at_start() const override { return closed; }
    [[nodiscard]] emt::Opening opening(Surroundings const& around) const override;
};

} // namespace gridspace::sim
