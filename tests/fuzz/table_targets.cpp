// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/topics.hpp"
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "gateways/gateway/route.hpp"
#include "gateways/mapping/record_reader.hpp"
#include "gateways/mapping/record_writer.hpp"
#include "gateways/scl/scl_export.hpp"
#include "gateways/scl/scl_import.hpp"
#include "gateways/scl/station.hpp"
#include "targets.hpp"

#include <algorithm>
#include <string>

namespace gridspace::fuzz {
namespace {

/// A valid table does what it says with zeros, and what it writes can be read.
void apply(gateways::Route& route) {
    std::vector<mapping::Value> in, out;
    for (auto const& [fields, values] : {std::pair{&route.from, &in}, std::pair{&route.to, &out}}) {
        for (mapping::Field const& field : *fields) {
            values->push_back({field.type, 0, 0, {}});
        }
    }
    route.rules.apply(in, out);
    route.on_loss.apply({}, out);
    if (route.to_type == nullptr) {
        return;
    }
    mapping::RecordWriter writer{*route.to_type, route.written, static_cast<std::size_t>(route.config.per_message)};
    std::copy(out.begin(), out.end(), writer.values().begin());
    (void)writer.append();
    (void)writer.write_key();
    mapping::RecordReader reader{*route.to_type};
    require(reader.read(writer.write(), out), "a sample that we wrote cannot be read");
}

} // namespace

void scl(std::uint8_t const* data, std::size_t size) {
    std::string const text(reinterpret_cast<char const*>(data), size);
    auto const imported = scl::import_streams(text, "fuzz.scd", {});
    if (imported) {
        config::Diagnostics diagnostics;
        auto streams = streams::read_streams(imported->streams, diagnostics);
        (void)diagnostics.render();
        std::erase_if(streams, [](streams::Stream const& s) { return s.broken; });
        std::string const again = scl::export_streams(streams, "fuzz").text;
        require(scl::import_streams(again, "again.scd", {}).has_value(), "an SCL file that we wrote cannot be read");
    }
    if (auto const document = scl::Document::parse(text, "fuzz.scd")) {
        auto const station = scl::read_station(*document, 50);
        require(!station || std::ranges::all_of(station->subscriptions,
                                                [&](scl::StreamSubscription const& one) {
                                                    return one.block < station->import.blocks.size();
                                                }),
                "a subscription to a control block that is not there");
    }
}

void mapping(std::uint8_t const* data, std::size_t size) {
    std::string const text(reinterpret_cast<char const*>(data), size);
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("fuzz.yaml", text), diagnostics);
    if (root && root->is_map()) {
        std::vector<streams::Stream> declared;
        gateways::GatewayConfig config;
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) {
            config::Node node;
            f.raw("streams", node);
            config::resolve_likes(node, diagnostics);
            declared = streams::read_streams(node, diagnostics);
            describe(f, config);
        });
        auto routes = gateways::make_routes(config, declared, bus::idl_of_type, diagnostics);
        for (gateways::Route& route : routes) {
            if (diagnostics.ok()) {
                apply(route);
            }
        }
    }
    (void)diagnostics.render();
}

} // namespace gridspace::fuzz
