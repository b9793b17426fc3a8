// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/expectation_rule.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {

std::string rule_of(Expectation const& e) {
    std::string verb = e.verb_name;
    std::ranges::replace(verb, '_', ' ');
    std::string out = verb + " " + (e.expression ? e.expression->text() : e.stream);
    for (auto const& [word, moment] : {std::pair{"since", &e.since}, {"from", &e.from}, {"until", &e.until}}) {
        out += *moment ? fmt::format(", {} {}", word, to_text(**moment)) : "";
    }
    return e.within_s ? fmt::format("{}, within {} s", out, shortest(*e.within_s)) : out;
}

} // namespace gridspace::launcher
