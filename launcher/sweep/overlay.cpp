// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/overlay.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <system_error>
#include <utility>

namespace gridspace::launcher {
namespace {

using config::Node;

void put(Node& root, std::string const& path, Node value) {
    Node* at = &root;
    std::vector<std::string> const parts = split(path, '.');
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
        Node* next = at->find(parts[i]);
        at = next != nullptr ? next : &at->set(parts[i], Node::map(value.where));
    }
    at->set(parts.back(), std::move(value));
}

/// A value without limits is shown and not judged; a condition is its own limit.
Node with_verdict(Node result) {
    static constexpr std::array kJudged{"is",        "above",  "below", "at_least",   "at_most",     "between",
                                        "show_only", "always", "never", "eventually", "intervals_ms"};
    bool const judged =
        std::any_of(kJudged.begin(), kJudged.end(), [&](char const* key) { return result.find(key) != nullptr; });
    if (result.is_map() && !judged) {
        result.set("show_only", Node::scalar("true", result.where));
    }
    return result;
}

/// Names of files are relative to the study in which they are written, and the overlay lies elsewhere. Which keys are
/// files is known to the scenario's reader alone; so a word counts as one if it has a dot or a slash and there is such
/// a file.
Node with_whole_paths(Node node) {
    for (Node& item : node.items) {
        item = with_whole_paths(std::move(item));
    }
    for (Node::Entry& entry : node.entries) {
        entry.value = with_whole_paths(std::move(entry.value));
    }
    if (node.is_scalar() && node.where.source != nullptr && node.text.find_first_of("./") != std::string::npos) {
        auto const path = std::filesystem::absolute(std::filesystem::path{node.where.source->directory} / node.text);
        std::error_code ignored;
        if (std::filesystem::is_regular_file(path, ignored)) {
            return Node::quoted_text(path.lexically_normal().string());
        }
    }
    return node;
}

} // namespace

Node overlay_of(Study const& study, Point const& point, std::string const& seed,
                std::vector<std::string> const& unwanted) {
    Node out = Node::map();
    for (Node::Entry const& entry : study.set.entries) {
        put(out, entry.key, entry.value);
    }
    for (std::size_t i = 0; i < point.size(); ++i) {
        for (Ref const& path : study.parameters[i].paths) {
            put(out, path.name, point[i]);
        }
    }
    for (std::string const& name : unwanted) {
        put(out, "expect." + name, Node{});
    }
    for (Node::Entry const& entry : study.results.entries) {
        put(out, "expect." + entry.key, with_verdict(entry.value));
    }
    if (!seed.empty()) {
        put(out, "seed", Node::scalar(seed));
    }
    return out;
}

std::string overlay_file(Study const& study, Node const& overlay) {
    Node file = with_whole_paths(overlay);
    file.set("extends", Node::quoted_text(study.scenario.string()));
    return fmt::format("# A run of the study '{}', made by `gridspace sweep`.\n---\n{}", study.name, to_yaml(file));
}

std::string cell_text(Node const& value) {
    switch (value.kind) {
    case Node::Kind::null:
        return "~";
    case Node::Kind::scalar:
        return value.text;
    case Node::Kind::sequence: {
        std::vector<std::string> items;
        for (Node const& item : value.items) {
            items.push_back(cell_text(item));
        }
        return "[" + join(items, ", ") + "]";
    }
    case Node::Kind::map:
        break;
    }
    std::vector<std::string> entries;
    for (Node::Entry const& entry : value.entries) {
        entries.push_back(entry.key + ": " + cell_text(entry.value));
    }
    return "{" + join(entries, ", ") + "}";
}

} // namespace gridspace::launcher
