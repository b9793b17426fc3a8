// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/gateway/gateway_config.hpp"

#include "common/text.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace gridspace::sim {
namespace {

using config::Diagnostics;
using config::Node;

/// A topic is spelled like an identifier: other DDS vendors refuse anything else.
void check_topic(Ref const& topic, Diagnostics& diagnostics) {
    auto const plain = [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    };
    if (topic.empty() || !std::all_of(topic.name.begin(), topic.name.end(), plain) ||
        (topic.name[0] >= '0' && topic.name[0] <= '9')) {
        diagnostics.error(topic.where, fmt::format("'{}' is not a topic name", topic.name),
                          "letters, digits and _, not beginning with a digit: every DDS implementation accepts those",
                          static_cast<int>(topic.name.size()));
    }
}

/// A map from topic names to something.
template <class Body>
void topics_of(Node const* node, std::string const& what, Diagnostics& diagnostics, Body&& body) {
    if (node == nullptr || node->is_null()) {
        return;
    }
    if (!node->is_map()) {
        diagnostics.error(node->where, fmt::format("{} is {}", what, config::describe(*node)),
                          "expected a map from topic names");
        return;
    }
    for (Node::Entry const& entry : node->entries) {
        Ref const topic{entry.key, entry.where};
        check_topic(topic, diagnostics);
        body(topic, entry.value);
    }
}

LineGatewayConfig::Publish read_bay(Ref const& topic, Node const& value, std::string const& gateway,
                                    Diagnostics& diagnostics) {
    LineGatewayConfig::Publish out{topic, {}, {}};
    config::read_fields(value, fmt::format("simulation.gateways.{}.publish.{}", gateway, topic.name), diagnostics,
                        [&](config::Fields& f) {
                            f.reference("ct", out.transformer, {.doc = "current transformer", .required = true});
                            f.reference("vt", out.voltage, {.doc = "voltage transformer", .required = true});
                        });
    return out;
}

LineGatewayConfig::Subscribe read_subscription(Ref const& topic, Node const& value, Diagnostics& diagnostics) {
    LineGatewayConfig::Subscribe out{topic, {}};
    if (value.is_scalar()) {
        out.breakers.push_back({value.text, value.where});
    }
    for (Node const& item : value.items) {
        out.breakers.push_back({item.text, item.where});
    }
    if (out.breakers.empty()) {
        diagnostics.error(topic.where, fmt::format("topic '{}' opens no breaker", topic.name),
                          "expected a list of breakers", static_cast<int>(topic.name.size()));
    }
    return out;
}

LineGatewayConfig read_gateway(Node::Entry const& entry, Diagnostics& diagnostics) {
    LineGatewayConfig gateway;
    gateway.name = {entry.key, entry.where};
    Node publish, subscribe;
    config::read_fields(entry.value, "simulation.gateways." + entry.key, diagnostics, [&](config::Fields& f) {
        f.raw("publish", publish, {.doc = "DDS topic: current transformer, or {ct: …, vt: …} of a bay"});
        f.raw("subscribe", subscribe, {.doc = "DDS topic: breakers that a trip command on it opens"});
    });
    topics_of(&publish, fmt::format("`publish` of gateway '{}'", entry.key), diagnostics,
              [&](Ref const& topic, Node const& value) {
                  if (value.is_scalar()) {
                      gateway.publish.push_back({topic, {value.text, value.where}, {}});
                  } else if (value.is_map()) {
                      gateway.publish.push_back(read_bay(topic, value, entry.key, diagnostics));
                  } else {
                      diagnostics.error(topic.where,
                                        fmt::format("topic '{}' publishes {}", topic.name, config::describe(value)),
                                        "expected the name of a current transformer, or {ct: …, vt: …}",
                                        static_cast<int>(topic.name.size()));
                  }
              });
    topics_of(&subscribe, fmt::format("`subscribe` of gateway '{}'", entry.key), diagnostics,
              [&](Ref const& topic, Node const& value) {
                  gateway.subscribe.push_back(read_subscription(topic, value, diagnostics));
              });
    return gateway;
}

} // namespace

void describe(config::Fields& f, SamplingConfig& s) {
    f.fraction("rate_hz", s.rate_hz, {.doc = "samples per second of every current transformer", .above = 0});
    f.integer("samples_per_message", s.samples_per_message,
              {.doc = "consecutive samples in one DDS message: fewer messages, and the oldest is older",
               .min = 1,
               .max = 64});
}

SamplingConfig read_sampling(Node const& sampling, Diagnostics& diagnostics) {
    SamplingConfig out;
    if (!sampling.is_null()) {
        config::read_fields(sampling, "simulation.sampling", diagnostics, [&](config::Fields& f) { describe(f, out); });
    }
    return out;
}

GatewaysConfig read_gateways(Node const& gateways, Diagnostics& diagnostics) {
    GatewaysConfig out;
    if (gateways.is_null()) {
        return out;
    }
    if (gateways.is_scalar()) {
        out.per_bus = gateways.text == "per_bus";
        if (!out.per_bus) {
            diagnostics.error(gateways.where, fmt::format("gateways is '{}'", gateways.text),
                              "expected per_bus, or a map of gateways with `publish` and `subscribe`",
                              static_cast<int>(gateways.text.size()));
        }
        return out;
    }
    if (!gateways.is_map()) {
        diagnostics.error(gateways.where, fmt::format("gateways is {}", config::describe(gateways)),
                          "expected per_bus, or a map of gateways");
        return out;
    }
    for (Node::Entry const& entry : gateways.entries) {
        if (!entry.value.is_map()) {
            diagnostics.error(entry.where, fmt::format("gateway '{}' is {}", entry.key, config::describe(entry.value)),
                              "expected a map with `publish` and `subscribe`");
            continue;
        }
        out.lines.push_back(read_gateway(entry, diagnostics));
    }
    return out;
}

void check_gateways(GatewaysConfig const& gateways, Network const& network, Diagnostics& diagnostics) {
    auto const must = [&](auto const& elements, Ref const& ref, Ref const& gateway, std::string_view kind) {
        if (find(elements, ref.name) != nullptr) {
            return;
        }
        std::vector<std::string> names;
        for (auto const& element : elements) {
            names.push_back(element.name.name);
        }
        diagnostics.error(
            ref.where,
            fmt::format("gateway '{}' names the {} '{}', which does not exist", gateway.name, kind, ref.name),
            spelling_hint(ref.name, names, fmt::format("the network has no {}", kind)),
            static_cast<int>(ref.name.size()));
    };
    std::map<std::string, Ref> published;
    for (LineGatewayConfig const& gateway : gateways.lines) {
        for (LineGatewayConfig::Publish const& p : gateway.publish) {
            must(network.cts, p.transformer, gateway.name, "current transformer");
            if (!p.voltage.empty()) {
                must(network.vts, p.voltage, gateway.name, "voltage transformer");
            }
            if (auto const [it, added] = published.try_emplace(p.topic.name, gateway.name); !added) {
                diagnostics.error(p.topic.where,
                                  fmt::format("topic '{}' is published by the gateways '{}' and '{}'", p.topic.name,
                                              it->second.name, gateway.name.name),
                                  "one of them needs another name", static_cast<int>(p.topic.name.size()));
            }
        }
        for (LineGatewayConfig::Subscribe const& s : gateway.subscribe) {
            for (Ref const& breaker : s.breakers) {
                must(network.breakers, breaker, gateway.name, "breaker");
            }
        }
    }
}

} // namespace gridspace::sim
