// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/protection_chain.hpp"

#include <initializer_list>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;

Node const* walk(Node const* node, std::initializer_list<std::string_view> path) {
    for (std::string_view const key : path) {
        node = node == nullptr ? nullptr : node->find(key);
    }
    return node;
}

std::string text_of(Node const* node, std::initializer_list<std::string_view> path) {
    Node const* const found = walk(node, path);
    return found == nullptr || !found->is_scalar() ? std::string{} : found->text;
}

/// Entries of a map; none when there is no such map.
std::vector<Node::Entry> const& entries(Node const* node) {
    static std::vector<Node::Entry> const none;
    return node == nullptr ? none : node->entries;
}

std::vector<std::string> names(Node const& node) {
    std::vector<std::string> out;
    if (node.is_scalar()) {
        out.push_back(node.text);
    }
    for (Node const& item : node.items) {
        out.push_back(item.text);
    }
    return out;
}

void follow_back(Node const& scenario, ProtectionChain::End& end, std::string& gateway_name) {
    for (Node::Entry const& process : entries(scenario.find("processes"))) {
        if (text_of(&process.value, {"program"}) == "gridspace-mu" && text_of(&process.value, {"to"}) == end.stream) {
            end.unit = process.key;
            end.topic = text_of(&process.value, {"from"});
        }
    }
    for (Node::Entry const& gateway : entries(walk(&scenario, {"simulation", "gateways"}))) {
        for (Node::Entry const& publish : entries(gateway.value.find("publish"))) {
            if (!end.topic.empty() && publish.key == end.topic) {
                end.transformer = publish.value.is_map() ? text_of(&publish.value, {"ct"}) : publish.value.text;
                gateway_name = gateway.key;
            }
        }
    }
}

std::vector<ProtectionChain::BreakerIed> follow_on(Node const& scenario, std::string const& trip_stream) {
    std::vector<ProtectionChain::BreakerIed> out;
    for (Node::Entry const& process : entries(scenario.find("processes"))) {
        std::string const from = text_of(&process.value, {"from"});
        if (text_of(&process.value, {"program"}) != "gridspace-breaker" ||
            from.substr(0, from.find('.')) != trip_stream) {
            continue;
        }
        ProtectionChain::BreakerIed ied{process.key, text_of(&process.value, {"to"}), {}};
        for (Node::Entry const& gateway : entries(walk(&scenario, {"simulation", "gateways"}))) {
            if (Node const* breakers = walk(&gateway.value, {"subscribe", ied.topic})) {
                ied.breakers = names(*breakers);
            }
        }
        out.push_back(std::move(ied));
    }
    return out;
}

} // namespace

std::vector<std::string> ProtectionChain::breakers() const {
    std::vector<std::string> out;
    for (BreakerIed const& ied : ieds) {
        out.insert(out.end(), ied.breakers.begin(), ied.breakers.end());
    }
    return out;
}

std::vector<ProtectionChain> protection_chains(Node const& scenario) {
    std::vector<ProtectionChain> out;
    for (Node::Entry const& process : entries(scenario.find("processes"))) {
        if (text_of(&process.value, {"program"}) != "gridspace-relay") {
            continue;
        }
        ProtectionChain chain;
        chain.relay = process.key;
        chain.trip_stream = text_of(&process.value, {"trip"});
        bool const is_bay = process.value.find("functions") != nullptr;
        chain.ends[0].stream =
            text_of(&process.value, is_bay ? std::initializer_list<std::string_view>{"inputs", "currents"}
                                           : std::initializer_list<std::string_view>{"currents", "from"});
        chain.ends[1].stream = text_of(&process.value, {"currents", "to"});
        for (ProtectionChain::End& end : chain.ends) {
            follow_back(scenario, end, chain.gateway);
        }
        chain.ieds = follow_on(scenario, chain.trip_stream);
        out.push_back(std::move(chain));
    }
    return out;
}

std::vector<ProtectionChain> foreign_chains(Node const& scenario) {
    std::set<std::string> known;
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        known.insert(chain.trip_stream);
    }
    std::vector<ProtectionChain> out;
    for (Node::Entry const& process : entries(scenario.find("processes"))) {
        std::string const from = text_of(&process.value, {"from"});
        std::string const stream = from.substr(0, from.find('.'));
        if (text_of(&process.value, {"program"}) == "gridspace-breaker" && !stream.empty() &&
            known.insert(stream).second) {
            ProtectionChain chain;
            chain.relay = chain.trip_stream = stream;
            chain.ieds = follow_on(scenario, stream);
            out.push_back(std::move(chain));
        }
    }
    return out;
}

} // namespace gridspace::launcher
