// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attacker_declaration.hpp"

#include <algorithm>

namespace gridspace::attacker {
namespace {

using program::Topic;

/// Each attack has its own reader and writer.
void add_topic(std::vector<Topic>& topics, Topic topic) {
    auto const same = std::ranges::find_if(topics, [&](Topic const& t) { return t.topic == topic.topic; });
    if (same == topics.end()) {
        topics.push_back(std::move(topic));
    } else {
        ++same->endpoints;
    }
}

} // namespace

program::Signal forged_signal(AttackConfig const& attack) {
    return {"attack." + attack.name.name + ".forged", "", 1};
}

program::Declaration declaration(AttackerConfig const& config, std::vector<AttackConfig const*> const& attacks,
                                 std::function<std::string(std::string const& topic)> const& type_of) {
    program::Declaration out{.name = "gridspace-attacker",
                             .description = "attacks on streams and topics, each labelled",
                             .role = "attacker",
                             .settings = config::keys_of<AttackerConfig>(),
                             .latency = "latency_us"};
    if (!config.labels.empty()) {
        out.writes.push_back({.topic = config.labels, .type = "AttackLabel"});
    }
    for (AttackConfig const* a : attacks) {
        out.signals.push_back(forged_signal(*a));
        if (a->place == AttackConfig::Place::second_publisher && !a->stream.empty()) {
            // What is listened to beside a publisher is what is sent there.
            out.reads.push_back({.topic = a->stream.name, .is_stream = true});
            if (a->waits_for_other()) {
                out.reads.push_back({.topic = a->when->stream.name, .is_stream = true});
            }
            out.writes.push_back({.topic = a->stream.name, .is_stream = true});
        }
        if (std::string const type = a->topic.empty() ? "" : type_of(a->topic.name); !type.empty()) {
            add_topic(out.reads, {.topic = a->topic.name, .type = type, .triggers = true, .optional = true});
            add_topic(out.writes, {.topic = a->topic.name, .type = type});
        }
    }
    return out;
}

program::Declaration attacker_declaration() {
    AttackerConfig config;
    config.labels = "{labels}";
    return declaration(config, {}, {});
}

} // namespace gridspace::attacker
