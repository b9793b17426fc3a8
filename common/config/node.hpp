// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::config {

/// A configuration tree that remembers where each value was written, through merging and overriding.
struct Node {
    enum class Kind { null, scalar, sequence, map };
    struct Entry;

    Kind kind{Kind::null};
    std::string text;           ///< of a scalar
    bool quoted{false};         ///< "30" in quotes is text, never a number
    std::vector<Node> items;    ///< of a sequence
    std::vector<Entry> entries; ///< of a map, in the order of the file
    SourceMark where;

    [[nodiscard]] bool is_null() const { return kind == Kind::null; }
    [[nodiscard]] bool is_scalar() const { return kind == Kind::scalar; }
    [[nodiscard]] bool is_sequence() const { return kind == Kind::sequence; }
    [[nodiscard]] bool is_map() const { return kind == Kind::map; }

    [[nodiscard]] Node const* find(std::string_view key) const; ///< nullptr when absent or not a map
    [[nodiscard]] Node* find(std::string_view key);
    [[nodiscard]] Entry const* find_entry(std::string_view key) const;
    Node& set(std::string_view key, Node value); ///< replaces or appends
    void erase(std::string_view key);

    [[nodiscard]] static Node scalar(std::string text, SourceMark where = {});
    [[nodiscard]] static Node quoted_text(std::string text, SourceMark where = {});
    [[nodiscard]] static Node map(SourceMark where = {});
    [[nodiscard]] static Node sequence(SourceMark where = {});
};

struct Node::Entry {
    std::string key;
    SourceMark where; ///< of the key
    Node value;
};

/// "a map", "a list", "text 'abc'", "nothing": for messages.
[[nodiscard]] std::string describe(Node const& node);

/// The tree as YAML that reads back to the same tree.
[[nodiscard]] std::string to_yaml(Node const& node);

} // namespace gridspace::config
