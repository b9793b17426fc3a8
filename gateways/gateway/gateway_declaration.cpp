// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/gateway_declaration.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

void add_published(std::vector<program::Signal>& out, GatewayConfig const& config, DeclarationContext const& context) {
    for (MappingConfig const& mapping : config.mappings) {
        streams::Stream const* stream = streams::find_stream(context.streams, mapping.to.stream.name);
        if (stream == nullptr || stream->kind != streams::Kind::smv) {
            continue;
        }
        if (out.empty()) {
            out = publisher_signals();
        }
        add(out, sent_sample_signals(stream->name.name));
    }
}

/// Names as Gateway::open_first_line makes them.
std::vector<GuardedStream> guarded_streams(GatewayConfig const& config, DeclarationContext const& context) {
    std::vector<GuardedStream> out;
    for (MappingConfig const& mapping : config.mappings) {
        streams::Stream const* stream = streams::find_stream(context.streams, mapping.from.stream.name);
        if (stream == nullptr || mapping.first_line.on_finding == FirstLineConfig::OnFinding::ignore) {
            continue;
        }
        bool const again = std::ranges::any_of(out, [&](auto const& w) { return w.name == stream->name.name; });
        out.push_back(guarded(context, again ? stream->name.name + "." + mapping.name.name : stream->name.name,
                              stream->kind == streams::Kind::smv));
    }
    return out;
}

} // namespace

std::vector<program::Signal> watched_signals(Route const& route) {
    std::vector<program::Signal> out;
    for (std::size_t const field : route.watched) {
        out.push_back(
            {"mapping.{process}." + route.config.name.name + "." + route.to[field].name, route.to[field].unit});
    }
    return out;
}

program::Declaration gateway_declaration() {
    return {.name = "gridspace-gateway",
            .description = "translates between DDS topics and IEC 61850 streams",
            .role = "gateway",
            .settings = config::keys_of<GatewayConfig>(),
            .latency = "latency_us"};
}

program::Declaration declaration(GatewayConfig const& config, std::vector<Route> const& routes,
                                 DeclarationContext const& context) {
    program::Declaration out = gateway_declaration();
    for (MappingConfig const& m : config.mappings) {
        if (m.from.is_topic()) {
            add_once(out.reads, {.topic = m.from.topic.name, .type = m.from.type.name, .triggers = true});
        } else if (!m.from.stream.empty()) {
            out.reads.push_back({.topic = m.from.stream.name, .is_stream = true});
        }
        if (m.to.is_topic()) {
            add_once(out.writes, {.topic = m.to.topic.name, .type = m.to.type.name, .optional = true});
        } else {
            out.writes.push_back({.topic = m.to.stream.name, .is_stream = true});
        }
    }
    for (SubscriptionConfig const& one : config.subscriptions) {
        out.reads.push_back({.topic = one.stream.name, .is_stream = true});
    }
    out.writes.push_back(stream_statistics());
    add_published(out.signals, config, context);
    add(out.signals, clock_signals(config.ptp, context));
    add(out.signals, first_line_signals({}, guarded_streams(config, context)));
    for (Route const& route : routes) {
        add(out.signals, watched_signals(route));
    }
    for (SubscriptionConfig const& one : config.subscriptions) {
        if (streams::Stream const* const stream = streams::find_stream(context.streams, one.stream.name)) {
            add(out.signals, subscription_signals(one, *stream));
        }
    }
    return out;
}

} // namespace gridspace::gateways
