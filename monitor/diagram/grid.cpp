// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/diagram/grid.hpp"

namespace gridspace::diagram {
namespace {

template <class T>
void list_of(config::Fields& f, std::string_view key, std::string_view doc, std::vector<T>& out, auto const& body) {
    f.list(key, {.doc = doc}, [&](config::Fields& item) {
        T entry;
        item.text("name", entry.name, {.required = true});
        body(item, entry);
        out.push_back(std::move(entry));
    });
}

} // namespace

void describe(config::Fields& f, Grid& grid) {
    f.number("frequency_hz", grid.frequency_hz, {.doc = "of the network", .min = 0});
    list_of(f, "buses", "of the network", grid.buses, [](config::Fields& b, Grid::Bus& out) {
        b.text("label", out.label);
        b.number("voltage_v", out.voltage_v);
        b.number("x", out.x);
        b.number("y", out.y);
    });
    list_of(f, "branches", "of the network", grid.branches, [](config::Fields& b, Grid::Branch& out) {
        b.text("label", out.label);
        b.text("from", out.from);
        b.text("to", out.to);
        b.text("kind", out.kind);
    });
    list_of(f, "breakers", "of the network", grid.breakers, [](config::Fields& b, Grid::Breaker& out) {
        b.text("line", out.line);
        b.text("end", out.end);
    });
    list_of(f, "cts", "current transformers of the network", grid.cts, [](config::Fields& c, Grid::Ct& out) {
        c.text("line", out.line);
        c.text("end", out.end);
    });
    list_of(f, "devices", "what hangs on the buses", grid.devices, [](config::Fields& d, Grid::Device& out) {
        d.text("label", out.label);
        d.text("bus", out.bus);
        d.text("kind", out.kind);
    });
    list_of(f, "relays", "and what belongs to them", grid.relays, [](config::Fields& r, Grid::Relay& out) {
        r.references("functions", out.functions);
        r.references("cts", out.cts);
        r.references("breakers", out.breakers);
    });
    list_of(f, "faults", "that the scenario applies", grid.faults, [](config::Fields& e, Grid::Fault& out) {
        e.text("line", out.line);
        e.text("bus", out.bus);
        e.number("position_percent", out.position_percent);
        e.number("at_s", out.at_s);
        e.number("until_s", out.until_s);
    });
}

} // namespace gridspace::diagram
