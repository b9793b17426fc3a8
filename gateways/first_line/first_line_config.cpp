// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line_config.hpp"

namespace gridspace::gateways {

void describe(config::Fields& f, FirstLineConfig& config) {
    using Action = FirstLineConfig::Action;
    f.object("first_line", {.doc = "rules on the headers of received frames"}, [&](config::Fields& r) {
        r.choice<Action>("action", config.action,
                         {{"off", Action::off}, {"alarm", Action::alarm}, {"drop", Action::drop}},
                         {.doc = "suspicious frames are not looked for, counted and reported, or also not taken"});
        r.flag("check_arrival", config.check_arrival,
               {.doc = "sampled values in real time: count arrivals outside median +- 6 MAD; never refuses"});
        r.flag("check_clock", config.check_clock,
               {.doc = "GOOSE: a new state's time is within 2 s of its arrival; needs synchronised clocks"});
    });
}

} // namespace gridspace::gateways
