// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/key.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gridspace::config {
namespace {

using Kind = Key::Kind;

constexpr std::array<std::string_view, 15> kKindNames{"number",   "integer", "fraction", "text",    "name",
                                                      "file",     "flag",    "word",     "numbers", "names",
                                                      "integers", "any",     "object",   "map",     "list"};

class KeyFields final : public Fields {
  public:
    explicit KeyFields(std::vector<Key>& keys) : keys_{keys} {}

    void number(std::string_view key, double& value, NumberSpec spec) override {
        set_default(add(key, Kind::number, spec), value, shortest(value));
    }
    void number(std::string_view key, std::optional<double>& value, NumberSpec spec) override {
        Key& added = add(key, Kind::number, spec);
        if (value) {
            set_default(added, *value, shortest(*value));
        }
    }
    void integer(std::string_view key, std::int64_t& value, NumberSpec spec) override {
        set_default(add(key, Kind::integer, spec), static_cast<double>(value), std::to_string(value));
    }
    void fraction(std::string_view key, Rational& value, NumberSpec spec) override {
        set_default(add(key, Kind::fraction, spec), value.to_double(), value.to_string());
    }
    void fraction(std::string_view key, std::optional<Rational>& value, NumberSpec spec) override {
        Key& added = add(key, Kind::fraction, spec);
        if (value) {
            set_default(added, value->to_double(), value->to_string());
        }
    }
    void text(std::string_view key, std::string& value, Spec spec) override {
        add(key, Kind::text, spec).default_text = spec.required ? "" : value;
    }
    void reference(std::string_view key, Ref& value, Spec spec) override {
        add(key, Kind::name, spec).default_text = value.name;
    }
    void file(std::string_view key, std::filesystem::path& value, Spec spec) override {
        add(key, Kind::file, spec).default_text = value.string();
    }
    void flag(std::string_view key, bool& value, Spec spec) override {
        add(key, Kind::flag, spec).default_text = spec.required ? "" : value ? "true" : "false";
    }
    void numbers(std::string_view key, std::vector<double>&, NumberSpec spec) override {
        add(key, Kind::numbers, spec);
    }
    void references(std::string_view key, std::vector<Ref>&, Spec spec) override { add(key, Kind::names, spec); }
    void integers(std::string_view key, std::map<std::string, std::int64_t>&, NumberSpec spec) override {
        add(key, Kind::integers, spec);
    }
    void raw(std::string_view key, Node&, Spec spec) override { add(key, Kind::any, spec); }

    bool object(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) override {
        nest(add(key, Kind::object, spec), body);
        return true;
    }
    void map(std::string_view key, Spec spec, std::function<void(Ref const&, Fields&)> const& body) override {
        nest(add(key, Kind::map, spec), [&](Fields& f) { body(Ref{"NAME", {}}, f); });
    }
    void list(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) override {
        nest(add(key, Kind::list, spec), body);
    }

    void error(std::string_view, std::string, std::string) override {}
    [[nodiscard]] bool has(std::string_view) const override { return false; }
    [[nodiscard]] SourceMark where(std::string_view) const override { return {}; }

  protected:
    std::optional<std::size_t> word(std::string_view key, std::span<std::string_view const> words, std::size_t current,
                                    Spec spec) override {
        Key& added = add(key, Kind::word, spec);
        added.words.assign(words.begin(), words.end());
        added.default_text = !spec.required && current < words.size() ? std::string{words[current]} : "";
        return std::nullopt;
    }

  private:
    /// A value outside of its own bounds stands for "not given".
    static void set_default(Key& key, double value, std::string text) {
        bool const outside = (key.min && value < *key.min) || (key.above && value <= *key.above) ||
                             (key.max && value > *key.max) || (key.below && value >= *key.below);
        key.default_text = key.required || outside || std::isnan(value) ? "" : std::move(text);
    }

    Key& add(std::string_view key, Kind kind, Spec spec) {
        auto const seen = std::find_if(keys_.begin(), keys_.end(), [&](Key const& k) { return k.key == key; });
        Key& entry = seen != keys_.end() ? *seen : keys_.emplace_back(); // a key may be described in two steps
        entry.key = key;
        entry.kind = kind;
        entry.doc = spec.doc;
        entry.required = spec.required;
        return entry;
    }
    Key& add(std::string_view key, Kind kind, NumberSpec const& spec) {
        Key& entry = add(key, kind, Spec{spec.doc, spec.required});
        auto const bound = [](double v) { return std::isinf(v) ? std::nullopt : std::optional{v}; };
        entry.min = bound(spec.min);
        entry.max = bound(spec.max);
        entry.above = bound(spec.above);
        entry.below = bound(spec.below);
        if (!spec.word.empty()) {
            entry.words = {std::string{spec.word}};
        }
        return entry;
    }
    static void nest(Key& entry, std::function<void(Fields&)> const& body) { entry.children = keys_of(body); }

    std::vector<Key>& keys_;
};

void read_word(Fields& fields, Key const& key, Spec const& spec) {
    std::vector<std::string_view> const words{key.words.begin(), key.words.end()};
    (void)fields.choice(key.key, words, spec);
}

void read_key(Fields& fields, Key const& key) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Spec const spec{.doc = key.doc, .required = key.required};
    NumberSpec const number{.doc = key.doc,
                            .required = key.required,
                            .min = key.min.value_or(-kInfinity),
                            .max = key.max.value_or(kInfinity),
                            .above = key.above.value_or(-kInfinity),
                            .below = key.below.value_or(kInfinity),
                            .word = key.words.empty() ? std::string_view{} : key.words.front()};
    auto const nested = [&](Fields& f) { read_keys(f, key.children); };
    auto const ignore = [&](auto value, auto member, auto const& how) { (fields.*member)(key.key, value, how); };
    switch (key.kind) {
    case Kind::number:
        return ignore(0.0, static_cast<void (Fields::*)(std::string_view, double&, NumberSpec)>(&Fields::number),
                      number);
    case Kind::integer:
        return ignore(std::int64_t{0}, &Fields::integer, number);
    case Kind::fraction:
        return ignore(Rational{0},
                      static_cast<void (Fields::*)(std::string_view, Rational&, NumberSpec)>(&Fields::fraction),
                      number);
    case Kind::text:
        return ignore(std::string{}, &Fields::text, spec);
    case Kind::name:
        return ignore(Ref{}, &Fields::reference, spec);
    case Kind::file:
        return ignore(std::filesystem::path{}, &Fields::file, spec);
    case Kind::flag:
        return ignore(false, &Fields::flag, spec);
    case Kind::word:
        return read_word(fields, key, spec);
    case Kind::numbers:
        return ignore(std::vector<double>{}, &Fields::numbers, number);
    case Kind::names:
        return ignore(std::vector<Ref>{}, &Fields::references, spec);
    case Kind::integers:
        return ignore(std::map<std::string, std::int64_t>{}, &Fields::integers, number);
    case Kind::any:
        return ignore(Node{}, &Fields::raw, spec);
    case Kind::object:
        fields.object(key.key, spec, nested);
        return;
    case Kind::map:
        return fields.map(key.key, spec, [&](Ref const&, Fields& f) { nested(f); });
    case Kind::list:
        return fields.list(key.key, spec, nested);
    }
}

} // namespace

std::vector<Key> keys_of(std::function<void(Fields&)> const& describe) {
    std::vector<Key> keys;
    KeyFields fields{keys};
    describe(fields);
    return keys;
}

void read_keys(Fields& fields, std::vector<Key> const& keys) {
    for (Key const& key : keys) {
        read_key(fields, key);
    }
}

std::string_view kind_name(Key::Kind kind) {
    return kKindNames.at(static_cast<std::size_t>(kind));
}

std::optional<Key::Kind> kind_of_name(std::string_view name) {
    auto const found = std::find(kKindNames.begin(), kKindNames.end(), name);
    return found == kKindNames.end() ? std::nullopt : std::optional{static_cast<Kind>(found - kKindNames.begin())};
}

} // namespace gridspace::config
