// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/link_config.hpp"

namespace gridspace::gateways {

void describe(config::Fields& f, LinkConfig& config) {
    using Direction = LinkConfig::Direction;
    f.object("place", {.doc = "which cable", .required = true}, [&](config::Fields& p) {
        p.references("between", config.between, {.doc = "a host and one of its links", .required = true});
        if (p.has("between") && config.between.size() != 2) {
            p.error("between", "a host and a link expected", "for example between: [mu21, process_bus]");
        }
    });
    f.choice<Direction>(
        "direction", config.direction,
        {{"from_host", Direction::from_host}, {"to_host", Direction::to_host}, {"both", Direction::both}},
        {.doc = "frames that the host sends, those that it receives, or both"});
}

} // namespace gridspace::gateways
