// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/described_settings.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

namespace gridspace::sdk {
namespace {

using config::Key;
using config::Node;
using Json = nlohmann::ordered_json;

Node completed(Key const& key, Node const& value) {
    Node out = value;
    switch (key.kind) {
    case Key::Kind::object:
        return with_defaults(value, key.children);
    case Key::Kind::map:
        for (Node::Entry& entry : out.entries) {
            entry.value = with_defaults(entry.value, key.children);
        }
        return out;
    case Key::Kind::list:
        for (Node& item : out.items) {
            item = with_defaults(item, key.children);
        }
        return out;
    default:
        return out;
    }
}

Json number_json(Node const& node) {
    std::int64_t whole = 0;
    char const* const end = node.text.data() + node.text.size();
    if (std::from_chars(node.text.data(), end, whole).ptr == end) {
        return whole;
    }
    auto const value = config::number_of(node);
    return value ? Json(*value) : Json(node.text);
}

Json json_of(Node const& node, Key::Kind kind, std::vector<Key> const& children);

Json map_json(Node const& node, std::vector<Key> const& keys) {
    Json out = Json::object();
    for (Node::Entry const& entry : node.entries) {
        auto const key = std::find_if(keys.begin(), keys.end(), [&](Key const& k) { return k.key == entry.key; });
        out[entry.key] = key == keys.end() ? json_of(entry.value, Key::Kind::any, {})
                                           : json_of(entry.value, key->kind, key->children);
    }
    return out;
}

Json scalar_json(Node const& node, Key::Kind kind) {
    switch (kind) {
    case Key::Kind::number:
    case Key::Kind::integer:
    case Key::Kind::numbers:
    case Key::Kind::integers:
        return number_json(node);
    case Key::Kind::flag:
        return node.text == "true";
    case Key::Kind::any:
        return node.quoted ? Json(node.text) : number_json(node);
    default:
        return node.text;
    }
}

Json json_of(Node const& node, Key::Kind kind, std::vector<Key> const& children) {
    if (node.is_null()) {
        return nullptr;
    }
    if (node.is_scalar()) {
        return scalar_json(node, kind);
    }
    if (node.is_sequence()) {
        Json out = Json::array();
        for (Node const& item : node.items) {
            out.push_back(kind == Key::Kind::list ? map_json(item, children) : json_of(item, kind, {}));
        }
        return out;
    }
    if (kind == Key::Kind::object) {
        return map_json(node, children);
    }
    Json out = Json::object();
    for (Node::Entry const& entry : node.entries) {
        out[entry.key] = kind == Key::Kind::map ? map_json(entry.value, children) : json_of(entry.value, kind, {});
    }
    return out;
}

} // namespace

Node with_defaults(Node const& settings, std::vector<Key> const& keys) {
    Node out = settings.is_map() ? settings : Node::map(settings.where);
    for (Key const& key : keys) {
        Node* const given = out.find(key.key);
        if (given != nullptr && !given->is_null()) {
            *given = completed(key, *given);
        } else if (key.kind == Key::Kind::object) {
            out.set(key.key, with_defaults(Node::map(), key.children));
        } else if (!key.default_text.empty()) {
            out.set(key.key, Node::scalar(key.default_text));
        }
    }
    return out;
}

std::optional<std::string> setting_at(Node const& settings, std::string_view path) {
    Node const* node = &settings;
    while (node != nullptr && !path.empty()) {
        std::size_t const dot = std::min(path.find('.'), path.size());
        node = node->find(path.substr(0, dot));
        path.remove_prefix(std::min(dot + 1, path.size()));
    }
    return node != nullptr && node->is_scalar() ? std::optional{node->text} : std::nullopt;
}

std::string to_json(Node const& settings, std::vector<Key> const& keys) {
    return map_json(settings, keys).dump(-1, ' ', false, Json::error_handler_t::replace);
}

program::Values values_of(Node const& settings, std::string const& process) {
    return [&settings, process](std::string_view key) -> std::vector<std::string> {
        if (key == "process") {
            return {process};
        }
        std::vector<std::string> out;
        Node const* node = settings.find(key);
        if (node == nullptr) {
            return out;
        }
        if (node->is_scalar()) {
            out.push_back(node->text);
        }
        for (Node const& item : node->items) {
            out.push_back(item.text);
        }
        for (Node::Entry const& entry : node->entries) {
            out.push_back(entry.key);
        }
        return out;
    };
}

} // namespace gridspace::sdk
