// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/expectation_check.hpp"

#include "launcher/judge/expectation.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {

void check_expectations(Scenario const& scenario, KnownSignals const& known, config::Diagnostics& diagnostics) {
    for (Expectation const& e : read_expectations(scenario.expect, diagnostics)) {
        if (!e.expression) {
            continue; // said already
        }
        config::Node const* settings = scenario.expect.find(e.name.name);
        config::Node const* written = settings == nullptr ? nullptr : settings->find(e.verb_name);
        KnownSignals::User user{fmt::format("expectation '{}'", e.name.name), e.name.where,
                                static_cast<int>(e.name.name.size()), e.show_only};
        KnownSignals::User verb = user;
        if (written != nullptr) {
            verb.where = written->where;
            verb.width = static_cast<int>(written->text.size());
        }
        known.check(e.expression->signals(), verb, diagnostics);
        for (std::optional<Moment> const* moment : {&e.from, &e.until, &e.since}) {
            known.check(*moment, user, diagnostics);
        }
    }
}

} // namespace gridspace::launcher
