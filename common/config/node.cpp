// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/node.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::config {
namespace {

bool needs_quotes(Node const& node) {
    std::string const& s = node.text;
    if (node.quoted || s.empty() || s == "~" || s == "null") {
        return true;
    }
    if (s.find_first_of("#:{}[],&*!|>'\"%@`\n\t\\") != std::string::npos || s.front() == ' ' || s.back() == ' ' ||
        s.front() == '?' || s.starts_with("---") || s.starts_with("...")) {
        return true;
    }
    // Control characters, and all beyond ASCII: some of it ends a line (U+0085, U+2028).
    if (std::any_of(s.begin(), s.end(), [](char c) {
            return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e;
        })) {
        return true;
    }
    return s.front() == '-' && (s.size() == 1 || s[1] == ' ');
}

std::string scalar_text(Node const& node) {
    if (!needs_quotes(node)) {
        return node.text;
    }
    std::string out = "\"";
    for (char const c : node.text) {
        switch (c) {
        case '"':
            out += "\\\"";
            break;
        case '\\':
            out += "\\\\";
            break;
        case '\n':
            out += "\\n";
            break;
        case '\t':
            out += "\\t";
            break;
        default:
            out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f
                       ? fmt::format("\\x{:02x}", static_cast<unsigned char>(c))
                       : std::string{c};
        }
    }
    return out + "\"";
}

bool is_flat(Node const& node) {
    return std::all_of(node.items.begin(), node.items.end(),
                       [](Node const& item) { return item.is_scalar() || item.is_null(); });
}

void emit(Node const& node, std::string& out, int indent, bool inline_start) {
    std::string const pad(static_cast<std::size_t>(indent), ' ');
    switch (node.kind) {
    case Node::Kind::null:
        out += " ~\n";
        break;
    case Node::Kind::scalar:
        out += " " + scalar_text(node) + "\n";
        break;
    case Node::Kind::sequence:
        if (is_flat(node)) {
            out += " [";
            for (std::size_t i = 0; i < node.items.size(); ++i) {
                out += (i == 0 ? "" : ", ");
                out += node.items[i].is_null() ? "~" : scalar_text(node.items[i]);
            }
            out += "]\n";
            break;
        }
        out += "\n";
        for (Node const& item : node.items) {
            out += pad + "-";
            emit(item, out, indent + 2, true);
        }
        break;
    case Node::Kind::map:
        if (node.entries.empty()) {
            out += " {}\n";
            break;
        }
        if (!inline_start) {
            out += "\n";
        }
        for (std::size_t i = 0; i < node.entries.size(); ++i) {
            out += (inline_start && i == 0) ? " " : pad;
            out += scalar_text(Node::scalar(node.entries[i].key)) + ":";
            emit(node.entries[i].value, out, indent + 2, false);
        }
        break;
    }
}

} // namespace

Node const* Node::find(std::string_view key) const {
    Entry const* entry = find_entry(key);
    return entry == nullptr ? nullptr : &entry->value;
}

Node* Node::find(std::string_view key) {
    auto const it = std::find_if(entries.begin(), entries.end(), [&](Entry const& e) { return e.key == key; });
    return it == entries.end() ? nullptr : &it->value;
}

Node::Entry const* Node::find_entry(std::string_view key) const {
    auto const it = std::find_if(entries.begin(), entries.end(), [&](Entry const& e) { return e.key == key; });
    return it == entries.end() ? nullptr : &*it;
}

Node& Node::set(std::string_view key, Node value) {
    if (Node* existing = find(key)) {
        *existing = std::move(value);
        return *existing;
    }
    SourceMark const mark = value.where;
    entries.push_back({std::string{key}, mark, std::move(value)});
    return entries.back().value;
}

void Node::erase(std::string_view key) {
    std::erase_if(entries, [&](Entry const& e) { return e.key == key; });
}

Node Node::scalar(std::string text, SourceMark where) {
    Node node;
    node.kind = Kind::scalar;
    node.text = std::move(text);
    node.where = std::move(where);
    return node;
}

Node Node::quoted_text(std::string text, SourceMark where) {
    Node node = scalar(std::move(text), std::move(where));
    node.quoted = true;
    return node;
}

Node Node::map(SourceMark where) {
    Node node;
    node.kind = Kind::map;
    node.where = std::move(where);
    return node;
}

Node Node::sequence(SourceMark where) {
    Node node;
    node.kind = Kind::sequence;
    node.where = std::move(where);
    return node;
}

std::string describe(Node const& node) {
    switch (node.kind) {
    case Node::Kind::null:
        return "nothing";
    case Node::Kind::sequence:
        return "a list";
    case Node::Kind::map:
        return "a map";
    case Node::Kind::scalar:
        break;
    }
    return fmt::format("'{}'", node.text);
}

std::string to_yaml(Node const& node) {
    std::string out;
    emit(node, out, 0, false);
    std::size_t const start = out.find_first_not_of(" \n");
    return start == std::string::npos ? "{}\n" : out.substr(start);
}

} // namespace gridspace::config
