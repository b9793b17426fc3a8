// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "common/rational.hpp"

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gridspace::config {

/// A name that was written in a configuration and refers to something; keeps its place for messages.
struct Ref {
    std::string name;
    SourceMark where;

    [[nodiscard]] bool empty() const { return name.empty(); }
    friend bool operator==(Ref const& a, Ref const& b) { return a.name == b.name; }
};

struct Spec {
    std::string_view doc{};
    bool required{false};
    bool may_be_empty{false}; ///< of a list of texts: an empty one may be among them
};

struct NumberSpec {
    std::string_view doc{};
    bool required{false};
    double min{-std::numeric_limits<double>::infinity()};
    double max{std::numeric_limits<double>::infinity()};
    double above{-std::numeric_limits<double>::infinity()}; ///< exclusive lower bound
    double below{std::numeric_limits<double>::infinity()};  ///< exclusive upper bound
    std::string_view word{}; ///< of a fraction: may stand in its place; there is no value then
};

/// The keys of one map. A configuration struct is described once, in `void describe(Fields&, T&)`; the same description
/// reads a file, writes the schema and the reference page. In-class defaults of T are the defaults.
///
/// A unit is the key's suffix (_s _ms _us _h _hz _v _kw _kva _a _ma _ohm _mh _km _pu _percent _deg …); values carry
/// none.
class Fields {
  public:
    virtual ~Fields() = default;

    virtual void number(std::string_view key, double& value, NumberSpec spec = {}) = 0;
    virtual void number(std::string_view key, std::optional<double>& value, NumberSpec spec = {}) = 0;
    virtual void integer(std::string_view key, std::int64_t& value, NumberSpec spec = {}) = 0;
    virtual void fraction(std::string_view key, Rational& value, NumberSpec spec = {}) = 0; ///< 1/48000 stays exact
    virtual void fraction(std::string_view key, std::optional<Rational>& value, NumberSpec spec = {}) = 0;
    virtual void text(std::string_view key, std::string& value, Spec spec = {}) = 0;
    virtual void reference(std::string_view key, Ref& value, Spec spec = {}) = 0;
    virtual void file(std::string_view key, std::filesystem::path& value,
                      Spec spec = {}) = 0; ///< relative to the naming file
    virtual void flag(std::string_view key, bool& value, Spec spec = {}) = 0;
    virtual void numbers(std::string_view key, std::vector<double>& value, NumberSpec spec = {}) = 0;
    virtual void references(std::string_view key, std::vector<Ref>& value, Spec spec = {}) = 0;
    virtual void integers(std::string_view key, std::map<std::string, std::int64_t>& value, NumberSpec spec = {}) = 0;
    virtual void raw(std::string_view key, Node& value, Spec spec = {}) = 0; ///< a subtree that a later stage reads

    /// A nested map. Returns whether it was given; `body` is run only then (always when a schema is written).
    virtual bool object(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) = 0;
    /// A map from names to maps: `body` is run for each. Names are checked to be identifiers.
    virtual void map(std::string_view key, Spec spec, std::function<void(Ref const& name, Fields&)> const& body) = 0;
    /// A list of maps.
    virtual void list(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) = 0;

    /// One of a few words.
    template <class E>
    void choice(std::string_view key, E& value, std::initializer_list<std::pair<std::string_view, E>> words,
                Spec spec = {}) {
        std::vector<std::string_view> names;
        std::size_t current = words.size();
        for (auto const& [name, meaning] : words) {
            if (meaning == value) {
                current = names.size();
            }
            names.push_back(name);
        }
        if (auto const index = word(key, names, current, spec)) {
            value = (words.begin() + static_cast<std::ptrdiff_t>(*index))->second;
        }
    }

    /// The same with words that are known at run time only: which of them it is.
    std::optional<std::size_t> choice(std::string_view key, std::span<std::string_view const> words, Spec spec = {}) {
        return word(key, words, words.size(), spec);
    }

    /// A mistake that only the owner of the struct can see. `key` empty: the map as a whole.
    virtual void error(std::string_view key, std::string message, std::string hint = {}) = 0;
    [[nodiscard]] virtual bool has(std::string_view key) const = 0;
    [[nodiscard]] virtual SourceMark where(std::string_view key = {}) const = 0;

  protected:
    virtual std::optional<std::size_t> word(std::string_view key, std::span<std::string_view const> words,
                                            std::size_t current, Spec spec) = 0;
};

/// Reads `node` (a map) by a description. `path` is its place from the root ("loads.L1"), for messages.
/// Keys that the description does not know are errors.
void read_fields(Node const& node, std::string const& path, Diagnostics& diagnostics,
                 std::function<void(Fields&)> const& body);

/// "kW", "seconds", … of a key by its suffix; empty when it has none.
[[nodiscard]] std::string_view unit_of_key(std::string_view key);

/// Reads the text of a scalar as a number: decimal, or an exact fraction like 1/48000. Nothing for anything else.
[[nodiscard]] std::optional<double> number_of(Node const& node);
/// The same as a whole number: decimal, or hexadecimal behind 0x.
[[nodiscard]] std::optional<std::int64_t> integer_of(Node const& node);

} // namespace gridspace::config
