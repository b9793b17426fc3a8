// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/network_config.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "sim/components/faces/number_specs.hpp"
#include "sim/network/matpower.hpp"
#include "sim/network/network_check.hpp"

namespace gridspace::sim {
namespace {

using config::Fields;

/// The keys by which an element says where it is.
void read_place(Fields& f, Element& e) {
    if (auto* one_port = dynamic_cast<OnePort*>(&e)) {
        f.reference("bus", one_port->bus, {.doc = "its bus", .required = true});
    } else if (auto* two_port = dynamic_cast<TwoPort*>(&e)) {
        f.reference("from", two_port->from, {.doc = "bus at the `from` end", .required = true});
        f.reference("to", two_port->to, {.doc = "bus at the `to` end", .required = true});
    } else if (auto* on_line = dynamic_cast<LineSwitch*>(&e)) {
        f.reference("line", on_line->line, {.doc = "the line that it switches", .required = true});
    }
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
        b.number("frequency_hz", n.frequency_hz, elements::positive("nominal frequency", true));
        b.number("power_kva", n.power_kva, elements::positive("base power", true));
    });
    for_each_kind(n, [&]<class T>(std::vector<T>& elements) {
        f.map(T::kKind.section, {.doc = T::kKind.doc}, [&](Ref const& name, Fields& e) {
            T element;
            element.name = name;
            e.text("label", element.label, {.doc = "text for displays; the name when not given"});
            read_place(e, element);
            element.fields(e);
            elements.push_back(std::move(element));
        });
    });
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
