// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
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

void erase(Node& map, std::set<std::string> const& keys) {
    if (!keys.empty()) {
        std::erase_if(map.entries, [&](Node::Entry const& entry) { return keys.contains(entry.key); });
    }
}

std::size_t values_in(Node const& node) {
    std::size_t out = 1;
    for (Node const& item : node.items) {
        out += values_in(item);
    }
    for (Node::Entry const& entry : node.entries) {
        out += values_in(entry.value);
    }
    return out;
}

} // namespace

void merge(Node& base, Node const& over) {
    if (!base.is_map() || !over.is_map()) {
        base = over;
        return;
    }
    std::map<std::string, std::size_t> places; // no search from the first key on for each
    for (std::size_t i = 0; i < base.entries.size(); ++i) {
        places.emplace(base.entries[i].key, i);
    }
    std::set<std::string> erased;
    for (Node::Entry const& entry : over.entries) {
        auto const place = places.find(entry.key);
        if (entry.value.is_null()) {
            erased.insert(entry.key);
        } else if (place == places.end()) {
            base.entries.push_back(entry);
        } else {
            Node::Entry& old = base.entries[place->second];
            old.where = entry.where;
            merge(old.value, entry.value);
        }
    }
    erase(base, erased);
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
    auto const lay_over = [&](Node over) {
        for (auto part = path.rbegin(); part != path.rend(); ++part) {
            Node parent = Node::map(where);
            parent.entries.push_back({*part, where, std::move(over)});
            over = std::move(parent);
        }
        merge(root, over);
    };
    if (value->is_map() && value->entries.empty()) {
        lay_over(Node{}); // merged with what stands there, an empty map would change nothing
    }
    lay_over(std::move(*value));
}

namespace {

/// The entries of one section, each of which may be like another.
class Likes {
  public:
    Likes(Node& section, Diagnostics& diagnostics)
        : section_{section}, diagnostics_{diagnostics}, states_(section.entries.size(), State::unresolved) {
        for (std::size_t i = 0; i < section.entries.size(); ++i) {
            names_.push_back(section.entries[i].key);
            places_.emplace(section.entries[i].key, i);
        }
    }

    void resolve() {
        for (std::size_t i = 0; i < states_.size() && copied_ <= kMaxYamlValues; ++i) {
            std::vector<std::pair<std::size_t, std::size_t>> chain; // who is like whom; the last is like nobody open
            for (std::optional<std::size_t> at = i; at && states_[*at] == State::unresolved;) {
                auto const other = like_of(*at);
                states_[*at] = other ? State::open : State::resolved;
                if (other) {
                    chain.emplace_back(*at, *other);
                }
                if (other && states_[*other] == State::open) {
                    diagnostics_.error(entry(*other).value.find("like")->where,
                                       fmt::format("'{}' is like itself", entry(*other).key));
                }
                at = other;
            }
            for (; !chain.empty() && copied_ <= kMaxYamlValues; chain.pop_back()) {
                take(entry(chain.back().first), entry(chain.back().second).value);
                states_[chain.back().first] = State::resolved;
            }
        }
    }

  private:
    enum class State : std::uint8_t { unresolved, open, resolved };

    Node::Entry& entry(std::size_t i) { return section_.entries[i]; }

    std::optional<std::size_t> like_of(std::size_t i) {
        Node const* const like = entry(i).value.is_map() ? entry(i).value.find("like") : nullptr;
        if (like == nullptr) {
            return std::nullopt;
        }
        auto const other = like->is_scalar() ? places_.find(like->text) : places_.end();
        if (other != places_.end()) {
            return other->second;
        }
        diagnostics_.error(like->where,
                           fmt::format("'{}' is like {}, which does not exist", entry(i).key, describe(*like)),
                           did_you_mean(like->text, names_), static_cast<int>(like->text.size()));
        entry(i).value.erase("like");
        return std::nullopt;
    }

    /// `entry` becomes `other` with its own values over it.
    void take(Node::Entry& entry, Node const& other) {
        copied_ += values_in(other);
        if (copied_ > kMaxYamlValues) {
            diagnostics_.error(entry.value.find("like")->where,
                               fmt::format("'like' stands for more than {} values here", kMaxYamlValues));
            return;
        }
        Node own = std::move(entry.value);
        own.erase("like");
        SourceMark const where = own.where;
        entry.value = &other == &entry.value ? Node::map() : other;
        entry.value.where = where;
        std::set<std::string> replaced{"like"}; // of one that is like itself
        for (Node::Entry const& beside : own.entries) {
            replaced.insert(beside.key); // a value is replaced whole: a data set is an order, not a heap to add to
        }
        erase(entry.value, replaced);
        merge(entry.value, own);
    }

    Node& section_;
    Diagnostics& diagnostics_;
    std::vector<State> states_;
    std::vector<std::string> names_;
    std::map<std::string, std::size_t> places_;
    std::size_t copied_{0};
};

} // namespace

void resolve_likes(Node& section, Diagnostics& diagnostics) {
    if (section.is_map()) {
        Likes{section, diagnostics}.resolve();
    }
}

} // namespace gridspace::config
