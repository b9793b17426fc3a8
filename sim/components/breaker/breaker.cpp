// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/breaker/breaker.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void BreakerType::fields(Fields& f) {
    f.number("mechanism_ms", mechanism_ms, not_negative("from the command to the parting of the contacts"));
    f.choice<Opens>("opens", opens,
                    {{"each_pole_at_current_zero", Opens::each_pole_at_current_zero}, {"at_once", Opens::at_once}},
                    {.doc = "when the current stops"});
    f.number("chop_a", chop_a, not_negative("a pole that opens interrupts a current that has fallen to this, in A"));
    if (chop_a > 0 && opens == Opens::at_once) {
        f.error("chop_a", fmt::format("breaker type '{}' opens at once and chops every current", name.name),
                "leave out one of `chop_a` and `opens: at_once`");
    }
    f.flag("latched", latched, {.doc = "a false trip signal never closes it"});
}

void Breaker::fields(Fields& f) {
    line_end(f, end);
    f.reference("type", type, {.doc = "breaker type", .required = true});
    f.choice<bool>("state", closed, {{"closed", true}, {"open", false}}, {.doc = "state at the start"});
}

emt::Opening Breaker::opening(Surroundings const& around) const {
    BreakerType const* found = around.find<BreakerType>(type);
    return found == nullptr ? emt::Opening{}
                            : emt::Opening{.after_s = found->mechanism_ms * 1e-3,
                                           .chop_a = found->chop_a,
                                           .at_once = found->opens == BreakerType::Opens::at_once};
}

} // namespace gridspace::sim
