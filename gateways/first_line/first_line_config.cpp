// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line_config.hpp"

namespace gridspace::gateways {

void describe(config::Fields& f, FirstLineConfig& config) {
    using OnFinding = FirstLineConfig::OnFinding;
    f.object(
        "first_line", {.doc = "rules for every frame of its streams: source, identity, counters, flags, arrival"},
        [&](config::Fields& r) {
            r.choice<OnFinding>(
                "on_finding", config.on_finding,
                {{"ignore", OnFinding::ignore}, {"report", OnFinding::report}, {"refuse", OnFinding::refuse}},
                {.doc = "a suspicious frame is used without a look, used and reported, or not used"});
            using InContest = FirstLineConfig::InContest;
            r.choice<InContest>("in_contest", config.in_contest,
                                {{"accept", InContest::accept}, {"refuse", InContest::refuse}},
                                {.doc = "GOOSE, with `on_finding: refuse`: two publishers with one address. Each new "
                                        "state is used, so a trip that either asks for is given; or none is, so a "
                                        "forger can hold a trip back"});
            r.flag(
                "check_clock", config.check_clock,
                {.doc =
                     "GOOSE: the time of a new state must be within 2 s of the own clock; both must be synchronised"});
        });
}

} // namespace gridspace::gateways
