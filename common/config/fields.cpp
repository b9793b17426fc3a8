// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/fields.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::config {
namespace {

struct Unit {
    std::string_view suffix;
    std::string_view name;
};
// Longest suffix first where one ends another.
constexpr std::array kUnits{
    Unit{"_ohm_per_km", "ohm/km"},
    Unit{"_nf_per_km", "nF/km"},
    Unit{"_mh_per_km", "mH/km"},
    Unit{"_per_hz", "1/Hz"},
    Unit{"_m_s", "m/s"},
    Unit{"_a2s", "A2s"},
    Unit{"_pu", "p.u."},
    Unit{"_percent", "%"},
    Unit{"_deg", "degrees"},
    Unit{"_ohm", "ohm"},
    Unit{"_mh", "mH"},
    Unit{"_uf", "uF"},
    Unit{"_nf", "nF"},
    Unit{"_km", "km"},
    Unit{"_kwh", "kWh"},
    Unit{"_kw", "kW"},
    Unit{"_mw", "MW"},
    Unit{"_kvar", "kvar"},
    Unit{"_kva", "kVA"},
    Unit{"_mva", "MVA"},
    Unit{"_kv", "kV"},
    Unit{"_va", "VA"},
    Unit{"_w", "W"},
    Unit{"_v", "V"},
    Unit{"_ka", "kA"},
    Unit{"_ma", "mA"},
    Unit{"_a", "A"},
    Unit{"_khz", "kHz"},
    Unit{"_hz", "Hz"},
    Unit{"_us", "microseconds"},
    Unit{"_ms", "milliseconds"},
    Unit{"_s", "seconds"},
    Unit{"_h", "hours"},
};

std::string bounds(NumberSpec const& spec) {
    std::string out;
    if (std::isfinite(spec.min)) {
        out += fmt::format(" >= {}", shortest(spec.min));
    }
    if (std::isfinite(spec.above)) {
        out += fmt::format(" > {}", shortest(spec.above));
    }
    if (std::isfinite(spec.max)) {
        out += fmt::format("{} <= {}", out.empty() ? "" : " and", shortest(spec.max));
    }
    if (std::isfinite(spec.below)) {
        out += fmt::format("{} < {}", out.empty() ? "" : " and", shortest(spec.below));
    }
    return out;
}

std::string expected_number(std::string_view key, std::string_view what, NumberSpec const& spec) {
    std::string_view const unit = unit_of_key(key);
    if (spec.min == spec.max) {
        return fmt::format("expected {}", shortest(spec.min));
    }
    return fmt::format("expected {}{}{}", what, unit.empty() ? "" : fmt::format(" in {}", unit), bounds(spec));
}

/// In whatever unit.
constexpr double kLargest = 1e15;

bool in_bounds(double v, NumberSpec const& spec) {
    return std::isfinite(v) && v >= spec.min && v <= spec.max && v > spec.above && v < spec.below;
}

int width_of(Node const& node) {
    return node.is_scalar() ? static_cast<int>(node.text.size()) + (node.quoted ? 2 : 0) : 1;
}

/// Fields over a Node: reads values, notes what it was asked for, reports the rest as unknown.
class NodeFields final : public Fields {
  public:
    NodeFields(Node const& node, std::string path, Diagnostics& diagnostics)
        : node_{node}, path_{std::move(path)}, diagnostics_{diagnostics} {}

    void finish() {
        std::vector<std::string> suggested;
        for (Node::Entry const& entry : node_.entries) {
            if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) {
                continue;
            }
            std::string const place = path_.empty() ? "" : fmt::format(" in {}", path_);
            diagnostics_.error(entry.where, fmt::format("unknown key '{}'{}", entry.key, place),
                               diagnostics_.full() ? "" : unknown_hint(entry.key, suggested),
                               static_cast<int>(entry.key.size()));
        }
        for (Missing const& missing : missing_) {
            if (std::find(suggested.begin(), suggested.end(), missing.key) == suggested.end()) { // said already
                diagnostics_.error(node_.where, missing.message, missing.hint);
            }
        }
    }

    void number(std::string_view key, double& value, NumberSpec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (auto const v = read_number(key, *node, spec)) {
                value = *v;
            }
        }
    }
    void number(std::string_view key, std::optional<double>& value, NumberSpec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (auto const v = read_number(key, *node, spec)) {
                value = *v;
            }
        }
    }
    void integer(std::string_view key, std::int64_t& value, NumberSpec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (auto const v = read_integer(key, *node, spec)) {
                value = *v;
            }
        }
    }
    void integers(std::string_view key, std::map<std::string, std::int64_t>& value, NumberSpec spec) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!node->is_map()) {
            wrong(key, *node, "expected a map from names to whole numbers");
            return;
        }
        for (Node::Entry const& entry : node->entries) {
            if (auto const v = read_integer(key, entry.value, spec)) {
                value[entry.key] = *v;
            }
        }
    }
    void fraction(std::string_view key, Rational& value, NumberSpec spec) override {
        std::optional<Rational> v;
        fraction(key, v, spec);
        if (v) {
            value = *v;
        }
    }
    void fraction(std::string_view key, std::optional<Rational>& value, NumberSpec spec) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!spec.word.empty() && node->is_scalar() && node->text == spec.word) {
            value.reset();
            return;
        }
        std::optional<Rational> const v =
            node->is_scalar() && !node->quoted ? Rational::parse(node->text) : std::nullopt;
        if (!v) {
            wrong(key, *node,
                  expected_number(key, "a number or a fraction like 1/48000", spec) +
                      (spec.word.empty() ? "" : fmt::format(", or {}", spec.word)));
        } else if (!in_bounds(v->to_double(), spec)) {
            out_of_range(key, *node, spec);
        } else {
            value = v;
        }
    }
    void text(std::string_view key, std::string& value, Spec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (node->is_scalar()) {
                value = node->text;
            } else {
                wrong(key, *node, "expected text");
            }
        }
    }
    void reference(std::string_view key, Ref& value, Spec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (node->is_scalar() && !node->text.empty()) {
                value = {node->text, node->where};
            } else {
                wrong(key, *node, "expected a name");
            }
        }
    }
    void file(std::string_view key, std::filesystem::path& value, Spec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (node->is_scalar() && !node->text.empty()) {
                std::string const base = node->where.source == nullptr ? "." : node->where.source->directory;
                value = (std::filesystem::path{base} / node->text).lexically_normal();
            } else {
                wrong(key, *node, "expected the path of a file");
            }
        }
    }
    void flag(std::string_view key, bool& value, Spec spec) override {
        if (Node const* node = get(key, spec.required)) {
            if (node->is_scalar() && !node->quoted && (node->text == "true" || node->text == "false")) {
                value = node->text == "true";
            } else {
                wrong(key, *node, "expected true or false");
            }
        }
    }
    void numbers(std::string_view key, std::vector<double>& value, NumberSpec spec) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!node->is_sequence()) {
            wrong(key, *node, "expected a list of numbers, for example [0, 0.5, 1]");
            return;
        }
        value.clear();
        for (Node const& item : node->items) {
            if (auto const v = read_number(key, item, spec)) {
                value.push_back(*v);
            }
        }
    }
    void references(std::string_view key, std::vector<Ref>& value, Spec spec) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!node->is_sequence()) {
            wrong(key, *node, "expected a list of names, for example [A, B]");
            return;
        }
        value.clear();
        for (Node const& item : node->items) {
            bool const empty = spec.may_be_empty && item.quoted && item.text.empty();
            if (empty || (item.is_scalar() && !item.text.empty())) {
                value.push_back({item.text, item.where});
            } else {
                wrong(key, item, "expected a name");
            }
        }
    }
    void raw(std::string_view key, Node& value, Spec spec) override {
        if (Node const* node = get(key, spec.required)) {
            value = *node;
        }
    }
    bool object(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return false;
        }
        if (!node->is_map()) {
            wrong(key, *node, "expected a map of keys");
            return false;
        }
        read_fields(*node, child(key), diagnostics_, body);
        return true;
    }
    void map(std::string_view key, Spec spec, std::function<void(Ref const&, Fields&)> const& body) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!node->is_map()) {
            wrong(key, *node, "expected a map from names to their settings");
            return;
        }
        for (Node::Entry const& entry : node->entries) {
            if (!is_identifier(entry.key)) {
                diagnostics_.error(entry.where,
                                   fmt::format("'{}' is not a name that {} may have", entry.key, child(key)),
                                   "letters, digits and _, not starting with a digit; `label:` takes any text",
                                   static_cast<int>(entry.key.size()));
            }
            std::string const path = fmt::format("{}.{}", child(key), entry.key);
            if (!entry.value.is_map()) {
                diagnostics_.error(entry.value.where.source == nullptr ? entry.where : entry.value.where,
                                   fmt::format("{} should be a map of keys, found {}", path, describe(entry.value)), "",
                                   width_of(entry.value));
                continue;
            }
            read_fields(entry.value, path, diagnostics_, [&](Fields& f) { body({entry.key, entry.where}, f); });
        }
    }
    void list(std::string_view key, Spec spec, std::function<void(Fields&)> const& body) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return;
        }
        if (!node->is_sequence()) {
            wrong(key, *node, "expected a list");
            return;
        }
        for (std::size_t i = 0; i < node->items.size(); ++i) {
            Node const& item = node->items[i];
            std::string const path = fmt::format("{}[{}]", child(key), i);
            if (!item.is_map()) {
                diagnostics_.error(item.where,
                                   fmt::format("{} should be a map of keys, found {}", path, describe(item)), "",
                                   width_of(item));
                continue;
            }
            read_fields(item, path, diagnostics_, body);
        }
    }
    void error(std::string_view key, std::string message, std::string hint) override {
        Node const* node = key.empty() ? nullptr : node_.find(key);
        diagnostics_.error(where(key), std::move(message), std::move(hint), node == nullptr ? 1 : width_of(*node));
    }
    [[nodiscard]] bool has(std::string_view key) const override { return node_.find(key) != nullptr; }
    [[nodiscard]] SourceMark where(std::string_view key) const override {
        Node const* node = key.empty() ? nullptr : node_.find(key);
        return node == nullptr ? node_.where : node->where;
    }

  protected:
    std::optional<std::size_t> word(std::string_view key, std::span<std::string_view const> words, std::size_t,
                                    Spec spec) override {
        Node const* node = get(key, spec.required);
        if (node == nullptr) {
            return std::nullopt;
        }
        if (node->is_scalar()) {
            for (std::size_t i = 0; i < words.size(); ++i) {
                if (words[i] == node->text) {
                    return i;
                }
            }
        }
        std::vector<std::string> const names{words.begin(), words.end()};
        auto const near = node->is_scalar() ? nearest_spelling(node->text, names) : std::nullopt;
        wrong(key, *node,
              (near ? fmt::format("did you mean '{}'? ", *near) : "") +
                  fmt::format("expected one of: {}", join(names, ", ")));
        return std::nullopt;
    }

  private:
    std::string child(std::string_view key) const {
        return path_.empty() ? std::string{key} : fmt::format("{}.{}", path_, key);
    }

    Node const* get(std::string_view key, bool required) {
        known_.emplace_back(key);
        Node const* node = node_.find(key);
        if (node != nullptr && node->is_null()) {
            node = nullptr; // `key: ~` is "not given"
        }
        if (node == nullptr && required) {
            std::string_view const unit = unit_of_key(key);
            missing_.push_back({std::string{key},
                                fmt::format("{} lacks the key '{}'", path_.empty() ? "the file" : path_, key),
                                unit.empty() ? "" : fmt::format("a value in {}", unit)});
        }
        return node;
    }

    std::optional<double> read_number(std::string_view key, Node const& node, NumberSpec const& spec) {
        std::optional<double> const v = number_of(node);
        if (!v) {
            wrong(key, node,
                  expected_number(key, "a number", spec) +
                      (unit_of_key(key).empty() ? "" : "; the unit is in the key"));
            return std::nullopt;
        }
        if (!in_bounds(*v, spec)) {
            out_of_range(key, node, spec);
            return std::nullopt;
        }
        if (std::abs(*v) > kLargest) {
            diagnostics_.error(
                node.where, fmt::format("{} is {}, which is larger than anything", child(key), node.text),
                fmt::format("expected at most {}: what is beyond would only overflow somewhere", shortest(kLargest)),
                width_of(node));
            return std::nullopt;
        }
        return v;
    }

    std::optional<std::int64_t> read_integer(std::string_view key, Node const& node, NumberSpec const& spec) {
        std::optional<std::int64_t> const v = integer_of(node);
        if (!v) {
            wrong(key, node, expected_number(key, "a whole number", spec));
            return std::nullopt;
        }
        if (!in_bounds(static_cast<double>(*v), spec)) {
            out_of_range(key, node, spec);
            return std::nullopt;
        }
        return v;
    }

    void wrong(std::string_view key, Node const& node, std::string expected) {
        diagnostics_.error(node.where, fmt::format("{} is {}", child(key), describe(node)), std::move(expected),
                           width_of(node));
    }

    void out_of_range(std::string_view key, Node const& node, NumberSpec const& spec) {
        diagnostics_.error(node.where, fmt::format("{} is {}, which is out of range", child(key), node.text),
                           expected_number(key, "a number", spec), width_of(node));
    }

    /// `suggested` collects the keys that were offered.
    std::string unknown_hint(std::string const& key, std::vector<std::string>& suggested) const {
        // Same quantity in another unit: "p_mw" where "p_kw" is the key.
        std::size_t const cut = key.rfind('_');
        for (std::string const& known : known_) {
            std::size_t const known_cut = known.rfind('_');
            if (cut != std::string::npos && known_cut == cut && known.compare(0, cut, key, 0, cut) == 0 &&
                !unit_of_key(key).empty() && !unit_of_key(known).empty()) {
                suggested.push_back(known);
                return fmt::format("did you mean '{}'? (in {})", known, unit_of_key(known));
            }
        }
        if (auto const near = nearest_spelling(key, known_)) {
            suggested.push_back(*near);
            std::string_view const unit = unit_of_key(*near);
            return fmt::format("did you mean '{}'?{}", *near, unit.empty() ? "" : fmt::format(" (in {})", unit));
        }
        if (known_.empty()) {
            return "no keys are expected here";
        }
        std::vector<std::string> sorted = known_;
        std::sort(sorted.begin(), sorted.end());
        sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
        return fmt::format("expected one of: {}", join(sorted, ", "));
    }

    Node const& node_;
    std::string path_;
    Diagnostics& diagnostics_;
    std::vector<std::string> known_;
    struct Missing {
        std::string key, message, hint;
    };
    std::vector<Missing> missing_;
};

} // namespace

void read_fields(Node const& node, std::string const& path, Diagnostics& diagnostics,
                 std::function<void(Fields&)> const& body) {
    NodeFields fields{node, path, diagnostics};
    body(fields);
    fields.finish();
}

std::string_view unit_of_key(std::string_view key) {
    for (Unit const& unit : kUnits) {
        if (key.ends_with(unit.suffix)) {
            return unit.name;
        }
    }
    return {};
}

std::optional<std::int64_t> integer_of(Node const& node) {
    if (!node.is_scalar() || node.quoted) {
        return std::nullopt;
    }
    std::string_view digits = node.text;
    int base = 10;
    if (digits.starts_with("0x") || digits.starts_with("0X")) {
        digits.remove_prefix(2);
        base = 16;
    }
    std::int64_t v = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v, base);
    return error == std::errc{} && end == digits.data() + digits.size() ? std::optional{v} : std::nullopt;
}

std::optional<double> number_of(Node const& node) {
    if (!node.is_scalar() || node.quoted) {
        return std::nullopt;
    }
    std::string_view digits = node.text;
    if (digits.starts_with('+')) {
        digits.remove_prefix(1);
    }
    double v = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
    if (error == std::errc{} && end == digits.data() + digits.size() && std::isfinite(v)) {
        return v;
    }
    if (auto const exact = Rational::parse(node.text)) {
        return exact->to_double();
    }
    return std::nullopt;
}

} // namespace gridspace::config
