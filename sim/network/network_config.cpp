// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network_config.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "sim/network/element_config.hpp"
#include "sim/network/matpower.hpp"
#include "sim/network/network_check.hpp"

namespace gridspace::sim {
namespace {

using namespace elements;

/// A section that maps names to elements: each is appended with its name.
template <class T>
void section(Fields& f, std::string_view key, std::string_view doc, std::vector<T>& elements,
             void (*one)(Fields&, T&)) {
    f.map(key, {.doc = doc}, [&](Ref const& name, Fields& e) {
        T element;
        element.name = name;
        e.text("label", element.label, {.doc = "text for displays; the name when not given"});
        one(e, element);
        elements.push_back(std::move(element));
    });
}

void bus(Fields& f, Bus& b) {
    f.number("voltage_v", b.voltage_v, positive("nominal voltage, line to line, r.m.s.", true));
    f.object("diagram", {.doc = "place in the one-line diagram"}, [&](Fields& d) {
        d.number("x", b.diagram_x, any("column"));
        d.number("y", b.diagram_y, any("row, downwards"));
    });
}

} // namespace

void describe(Fields& f, Network& n) {
    n.where = f.where();
    std::int64_t version = 1;
    f.integer("gridspace_network", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", n.name, {.doc = "name of the network", .required = true});
    std::string description;
    f.text("description", description, {.doc = "what it is"});
    f.object("base", {.doc = "base values", .required = true}, [&](Fields& b) {
        b.number("frequency_hz", n.frequency_hz, positive("nominal frequency", true));
        b.number("power_kva", n.power_kva, positive("base power", true));
    });
    section(f, "buses", "buses", n.buses, bus);
    section(f, "sources", "stiff networks behind an impedance", n.sources, source);
    section(f, "line_types", "line data per km", n.line_types, line_type);
    section(f, "lines", "lines", n.lines, line);
    section(f, "transformers", "two-winding transformers", n.transformers, transformer);
    section(f, "breaker_types", "breaker data", n.breaker_types, breaker_type);
    section(f, "breakers", "breakers at line ends", n.breakers, breaker);
    section(f, "ct_types", "current transformer data", n.ct_types, ct_type);
    section(f, "cts", "current transformers at line ends", n.cts, ct);
    section(f, "vt_types", "voltage transformer data", n.vt_types, vt_type);
    section(f, "vts", "voltage transformers at buses", n.vts, vt);
    section(f, "machine_types", "synchronous machine data", n.machine_types, machine_type);
    section(f, "machines", "synchronous machines", n.machines, machine);
    section(f, "generators", "generators without dynamics", n.generators, generator);
    for_each_kind(n, [&]<class T>(std::vector<T>& elements) {
        section<T>(f, T::kKind.section, T::kKind.doc, elements, [](Fields& e, T& element) {
            e.reference("bus", element.bus, {.doc = "its bus", .required = true});
            element.fields(e);
        });
    });
    section(f, "profiles", "values over time", n.profiles, profile);
}

std::optional<Network> read_network(config::Node const& root, config::Diagnostics& diagnostics) {
    auto const* processes = root.find_entry("processes");
    if (processes != nullptr && root.find("gridspace_network") == nullptr) {
        diagnostics.error(processes->where, "this is a scenario file, and a network is expected",
                          "give the file that its simulation.network names, or `gridspace run` the scenario");
        return std::nullopt;
    }
    Network network;
    int const before = diagnostics.errors();
    config::read_fields(root, "", diagnostics, [&](Fields& f) { describe(f, network); });
    if (diagnostics.errors() == before) {
        check_network(network, diagnostics);
    }
    return diagnostics.errors() == before ? std::optional{std::move(network)} : std::nullopt;
}

std::optional<Network> load_network(std::filesystem::path const& file, config::Diagnostics& diagnostics,
                                    config::SourceMark named_at) {
    if (file.extension() == ".m") {
        return load_matpower(file, diagnostics, std::move(named_at));
    }
    std::optional<config::Node> const root = config::load_extended(file, diagnostics, named_at);
    return root ? read_network(*root, diagnostics) : std::nullopt;
}

} // namespace gridspace::sim
