// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/published.hpp"

namespace gridspace::launcher {

void describe(config::Fields& f, Published& p) {
    f.text("source", p.source, {.doc = "where the values come from"});
    f.object("smv", {.doc = "sampled values"}, [&](config::Fields& g) {
        g.text("figure", p.smv_figure, {.doc = "its number, for the caption"});
        g.number("rate_hz", p.smv_rate_hz, {.doc = "mean rate", .above = 0});
        g.number("delay_ms", p.smv_delay_ms, {.doc = "mean delay", .min = 0});
    });
    f.object("goose", {.doc = "GOOSE"},
             [&](config::Fields& g) { g.number("delay_ms", p.goose_delay_ms, {.doc = "mean delay", .min = 0}); });
    f.object("delays", {.doc = "delays"}, [&](config::Fields& g) {
        g.text("figure", p.delay_table, {.doc = "number of the table, for the caption"});
        g.number("limit_ms", p.delay_limit_ms, {.doc = "limit that they are held against", .above = 0});
    });
}

Published published_of(config::Node const& scenario) {
    Published out;
    if (config::Node const* node = scenario.find("published"); node != nullptr && node->is_map()) {
        config::Diagnostics ignored; // the run was started with it
        config::read_fields(*node, "published", ignored, [&](config::Fields& f) { describe(f, out); });
    }
    return out;
}

} // namespace gridspace::launcher
