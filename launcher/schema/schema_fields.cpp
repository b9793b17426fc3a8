// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/schema/schema_fields.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::launcher {
namespace {

using config::Fields;
using config::Node;
using config::NumberSpec;
using config::Ref;
using config::Spec;
using Kind = SchemaKey::Kind;

class SchemaFields final : public Fields {
  public:
    explicit SchemaFields(std::vector<SchemaKey>& keys) : keys_{keys} {}

    void number(std::string_view key, double& value, NumberSpec spec) override {
        add(key, Kind::number, spec).default_text = text_of(value, spec.required);
    }
    void number(std::string_view key, std::optional<double>& value, NumberSpec spec) override {
        add(key, Kind::number, spec).default_text = value ? text_of(*value, spec.required) : "";
    }
    void integer(std::string_view key, std::int64_t& value, NumberSpec spec) override {
        add(key, Kind::integer, spec).default_text = spec.required ? "" : std::to_string(value);
    }
    void fraction(std::string_view key, Rational& value, NumberSpec spec) override {
        add(key, Kind::fraction, spec).default_text = spec.required ? "" : value.to_string();
    }
    void fraction(std::string_view key, std::optional<Rational>& value, NumberSpec spec) override {
        add(key, Kind::fraction, spec).default_text = value ? value->to_string() : "";
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
    [[nodiscard]] config::SourceMark where(std::string_view) const override { return {}; }

  protected:
    std::optional<std::size_t> word(std::string_view key, std::span<std::string_view const> words, std::size_t current,
                                    Spec spec) override {
        SchemaKey& added = add(key, Kind::word, spec);
        added.words.assign(words.begin(), words.end());
        added.default_text = !spec.required && current < words.size() ? std::string{words[current]} : "";
        return std::nullopt;
    }

  private:
    static std::string text_of(double value, bool required) {
        return required || std::isnan(value) ? "" : shortest(value);
    }

    SchemaKey& add(std::string_view key, Kind kind, Spec spec) {
        auto const seen = std::find_if(keys_.begin(), keys_.end(), [&](SchemaKey const& k) { return k.key == key; });
        SchemaKey& entry = seen != keys_.end() ? *seen : keys_.emplace_back(); // a key may be described in two steps
        entry.key = key;
        entry.kind = kind;
        entry.doc = spec.doc;
        entry.required = spec.required;
        return entry;
    }
    SchemaKey& add(std::string_view key, Kind kind, NumberSpec const& spec) {
        SchemaKey& entry = add(key, kind, Spec{spec.doc, spec.required});
        auto const bound = [](double v) { return std::isinf(v) ? std::nullopt : std::optional{v}; };
        entry.min = bound(spec.min);
        entry.max = bound(spec.max);
        entry.above = bound(spec.above);
        entry.below = bound(spec.below);
        return entry;
    }
    static void nest(SchemaKey& entry, std::function<void(Fields&)> const& body) { entry.children = keys_of(body); }

    std::vector<SchemaKey>& keys_;
};

} // namespace

std::vector<SchemaKey> keys_of(std::function<void(config::Fields&)> const& describe) {
    std::vector<SchemaKey> keys;
    SchemaFields fields{keys};
    describe(fields);
    return keys;
}

} // namespace gridspace::launcher
