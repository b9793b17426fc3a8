// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/impairments.hpp"

#include "common/text.hpp"
#include "gateways/link/impairment.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

constexpr std::string_view kProgram = "gridspace-link";

Node& section(Node& root, std::string_view name) {
    Node* found = root.find(name);
    return found == nullptr ? root.set(name, Node::map(root.where)) : *found;
}

} // namespace

void expand_impairments(Node& root, Diagnostics& diagnostics) {
    Node const* written = root.find("impairments");
    if (written == nullptr) {
        return;
    }
    if (!written->is_map()) {
        if (!written->is_null()) {
            diagnostics.error(written->where, fmt::format("impairments is {}", config::describe(*written)),
                              "expected entries by name");
        }
        root.erase("impairments");
        return;
    }
    Node const entries = *written;
    root.erase("impairments");
    for (Node::Entry const& entry : entries.entries) {
        if (entry.value.is_null()) {
            continue; // taken away again
        }
        for (char const* other : {"hosts", "processes"}) {
            Node& names = section(root, other);
            if (names.find(entry.key) != nullptr) {
                diagnostics.error(entry.where,
                                  fmt::format("'{}' is a name of `impairments:` and of `{}:`", entry.key, other),
                                  "an impairment is a process on a host of its own, both of its name",
                                  static_cast<int>(entry.key.size()));
                return;
            }
        }
        if (!entry.value.is_map()) {
            diagnostics.error(entry.value.where,
                              fmt::format("impairments.{} is {}", entry.key, config::describe(entry.value)),
                              "expected a map");
            continue;
        }
        Node host = Node::map(entry.where);
        host.set("links", Node::sequence(entry.where));
        section(root, "hosts").entries.push_back({entry.key, entry.where, std::move(host)});
        Node process = entry.value;
        process.set("program", Node::scalar(std::string{kProgram}, entry.where));
        process.set("host", Node::scalar(entry.key, entry.where));
        section(root, "processes").entries.push_back({entry.key, entry.where, std::move(process)});
    }
}

void check_impairment_events(Scenario const& scenario, Diagnostics& diagnostics) {
    std::vector<std::string> names;
    for (Process const& process : scenario.processes) {
        if (process.program.name == kProgram) {
            names.push_back(process.name.name);
        }
    }
    for (sim::Event const& event : scenario.events) {
        for (auto const& [path, value] : event.set_impairments) {
            int const width = static_cast<int>(path.name.size());
            std::vector<std::string> const parts = split(path.name, '.');
            if (parts.size() != 3) {
                diagnostics.error(path.where, fmt::format("event '{}' sets '{}'", event.name.name, path.name),
                                  "expected impairments.NAME.KEY, for example impairments.cable.loss_percent", width);
                continue;
            }
            auto const must_be = [&](std::string const& word, std::vector<std::string> const& words,
                                     std::string_view what) {
                if (std::find(words.begin(), words.end(), word) != words.end()) {
                    return true;
                }
                diagnostics.error(path.where,
                                  fmt::format("event '{}' sets '{}', and there is no {} '{}'", event.name.name,
                                              path.name, what, word),
                                  spelling_hint(word, words, "the scenario has no impairments"), width);
                return false;
            };
            bool const known = must_be(parts[1], names, "impairment");
            if (!must_be(parts[2], gateways::impairment_keys(), "key") || !known) {
                continue;
            }
            if (std::string const wrong = gateways::wrong_with_impairment(parts[2], value); !wrong.empty()) {
                diagnostics.error(
                    path.where, fmt::format("event '{}' sets '{}' to {}", event.name.name, path.name, shortest(value)),
                    wrong, width);
            }
        }
    }
}

Node impairment_changes(Scenario const& scenario, std::string const& process) {
    std::vector<std::pair<Rational, Node>> changes;
    for (sim::Event const& event : scenario.events) {
        for (auto const& [path, value] : event.set_impairments) {
            std::vector<std::string> const parts = split(path.name, '.');
            if (parts.size() != 3 || parts[1] != process || !event.at_s) {
                continue;
            }
            Node node = Node::map();
            node.set("at_s", Node::scalar(event.at_s->to_string()));
            node.set("key", Node::quoted_text(parts[2]));
            node.set("value", Node::scalar(shortest(value)));
            changes.emplace_back(*event.at_s, std::move(node));
        }
    }
    std::stable_sort(changes.begin(), changes.end(), [](auto const& a, auto const& b) { return a.first < b.first; });
    Node list = Node::sequence();
    for (auto& [at, node] : changes) {
        list.items.push_back(std::move(node));
    }
    return list;
}

} // namespace gridspace::launcher
