// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::config {
namespace {

std::optional<Node> load_chain(std::filesystem::path const& file, SourceMark named_at,
                               std::vector<std::filesystem::path> chain, Diagnostics& diagnostics) {
    std::error_code ignored;
    std::filesystem::path const identity = std::filesystem::weakly_canonical(file, ignored);
    if (std::find(chain.begin(), chain.end(), identity) != chain.end()) {
        diagnostics.error(named_at, fmt::format("'{}' extends itself", file.string()));
        return std::nullopt;
    }
    chain.push_back(identity);
    std::optional<Node> own = load_yaml(file, diagnostics, named_at);
    if (!own) {
        return std::nullopt;
    }
    if (!own->is_map()) {
        diagnostics.error(own->where, fmt::format("expected a map of keys, found {}", describe(*own)));
        return std::nullopt;
    }
    Node const* extends = own->find("extends");
    if (extends == nullptr) {
        return own;
    }
    if (!extends->is_scalar()) {
        diagnostics.error(extends->where, fmt::format("'extends' names one file, found {}", describe(*extends)));
        return std::nullopt;
    }
    std::filesystem::path const base_file = std::filesystem::path{extends->where.source->directory} / extends->text;
    std::optional<Node> base = load_chain(base_file.lexically_normal(), extends->where, std::move(chain), diagnostics);
    if (!base) {
        return std::nullopt;
    }
    own->erase("extends");
    merge(*base, *own);
    return base;
}

} // namespace

void merge(Node& base, Node const& over) {
    if (!base.is_map() || !over.is_map()) {
        base = over;
        return;
    }
    for (Node::Entry const& entry : over.entries) {
        if (entry.value.is_null()) {
            base.erase(entry.key);
            continue;
        }
        auto const it = std::find_if(base.entries.begin(), base.entries.end(),
                                     [&](Node::Entry const& e) { return e.key == entry.key; });
        if (it == base.entries.end()) {
            base.entries.push_back(entry);
        } else {
            it->where = entry.where;
            merge(it->value, entry.value);
        }
    }
}

std::optional<Node> load_extended(std::filesystem::path const& file, Diagnostics& diagnostics, SourceMark named_at) {
    return load_chain(file, std::move(named_at), {}, diagnostics);
}

void apply_set(Node& root, std::string const& assignment, int number, Diagnostics& diagnostics) {
    auto const source = make_source(fmt::format("--set #{}", number), assignment);
    std::size_t const equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) {
        diagnostics.error({source, 1, 1}, "expected path=value, for example --set clock.speed=1");
        return;
    }
    std::vector<std::string> const path = split(assignment.substr(0, equals), '.');
    if (std::any_of(path.begin(), path.end(), [](std::string const& part) { return part.empty(); })) {
        diagnostics.error({source, 1, 1}, "the path has an empty part", "", static_cast<int>(equals));
        return;
    }
    auto const value_source = make_source(source->name, assignment);
    std::optional<Node> value = parse_yaml(assignment.substr(equals + 1), value_source, diagnostics);
    if (!value) {
        return;
    }
    // One nested map, so that an override follows the rules of any other file. All of it is "written" at --set.
    SourceMark const where{source, 1, 1};
    struct Mark {
        static void everywhere(Node& node, SourceMark const& mark) {
            node.where = mark;
            for (Node& item : node.items) {
                everywhere(item, mark);
            }
            for (Node::Entry& entry : node.entries) {
                entry.where = mark;
                everywhere(entry.value, mark);
            }
        }
    };
    SourceMark value_mark = where;
    value_mark.column = static_cast<int>(equals) + 2;
    Mark::everywhere(*value, value_mark);
    Node over = std::move(*value);
    for (auto part = path.rbegin(); part != path.rend(); ++part) {
        Node parent = Node::map(where);
        parent.entries.push_back({*part, where, std::move(over)});
        over = std::move(parent);
    }
    merge(root, over);
}

void resolve_likes(Node& section, Diagnostics& diagnostics) {
    if (!section.is_map()) {
        return;
    }
    std::set<std::string> done, open;
    auto const resolve = [&](auto&& self, Node::Entry& entry) -> void {
        Node const* like = entry.value.is_map() ? entry.value.find("like") : nullptr;
        if (like == nullptr || done.contains(entry.key)) {
            done.insert(entry.key);
            return;
        }
        if (open.contains(entry.key)) {
            diagnostics.error(like->where, fmt::format("'{}' is like itself", entry.key));
            entry.value.erase("like");
            return;
        }
        open.insert(entry.key);
        auto const other = std::find_if(section.entries.begin(), section.entries.end(),
                                        [&](Node::Entry const& e) { return like->is_scalar() && e.key == like->text; });
        if (other == section.entries.end()) {
            std::vector<std::string> names;
            for (Node::Entry const& e : section.entries) {
                names.push_back(e.key);
            }
            diagnostics.error(like->where,
                              fmt::format("'{}' is like {}, which does not exist", entry.key, describe(*like)),
                              did_you_mean(like->text, names), static_cast<int>(like->text.size()));
            entry.value.erase("like");
        } else {
            self(self, *other);
            Node own = std::move(entry.value);
            own.erase("like");
            SourceMark const where = own.where;
            entry.value = other->value;
            entry.value.where = where;
            for (Node::Entry const& beside : own.entries) {
                entry.value.erase(
                    beside.key); // a value is replaced whole: a data set is an order, not a heap to add to
            }
            merge(entry.value, own);
        }
        open.erase(entry.key);
        done.insert(entry.key);
    };
    for (Node::Entry& entry : section.entries) {
        resolve(resolve, entry);
    }
}

} // namespace gridspace::config
