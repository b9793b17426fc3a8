// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/wire_config.hpp"

#include "common/config/merge.hpp"
#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {

namespace {

void describe_place(config::Fields& w, WirePlace& place) {
    w.text("link", place.link, {.doc = "name of the link"});
    w.text("receive_link", place.receive_link,
           {.doc = "name of the piece of cable that frames come from, when something sits in it"});
    w.text("interface", place.interface, {.doc = "network interface", .required = true});
}

} // namespace

void describe_wire(config::Fields& f, WireConfig& wire) {
    f.object("wire", {.doc = "its port", .required = true}, [&](config::Fields& w) {
        describe_place(w, wire);
        w.object("prp_lan_b", {.doc = "its port on network B, of a doubly attached node (PRP)"},
                 [&](config::Fields& b) { describe_place(b, wire.lan_b.emplace()); });
        w.number("speed", wire.speed, {.doc = "of the simulation clock, in real time", .above = 0});
    });
    config::Node node;
    f.raw("streams", node, {.doc = "the streams that it sends or receives", .required = true});
    config::Diagnostics diagnostics;
    if (node.is_map()) {
        config::resolve_likes(node, diagnostics);
    }
    wire.streams = streams::read_streams(node, diagnostics);
    if (!diagnostics.ok()) {
        f.error("streams", diagnostics.render());
    }
}

streams::Stream const* stream_of(std::vector<streams::Stream> const& declared, config::Ref const& ref,
                                 streams::Kind kind, config::Diagnostics& diagnostics) {
    streams::Stream const* stream = streams::find_stream(declared, ref.name);
    std::string const wanted = kind == streams::Kind::smv ? "smv" : "goose";
    if (stream == nullptr) {
        std::vector<std::string> names;
        for (streams::Stream const& s : declared) {
            if (s.kind == kind || s.broken) {
                names.push_back(s.name.name);
            }
        }
        diagnostics.error(ref.where, fmt::format("there is no stream '{}'", ref.name),
                          spelling_hint(ref.name, names, fmt::format("`streams:` declares none of kind {}", wanted)),
                          static_cast<int>(ref.name.size()));
        return nullptr;
    }
    if (stream->broken) {
        return nullptr;
    }
    if (stream->kind != kind) {
        diagnostics.error(ref.where, fmt::format("stream '{}' is not of kind {}", ref.name, wanted), "",
                          static_cast<int>(ref.name.size()));
        return nullptr;
    }
    return stream;
}

} // namespace gridspace::gateways
